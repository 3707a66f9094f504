#include "conformance/report/sequence.h"

#include <fmt/format.h>

#include <algorithm>

namespace rubric::report {
namespace {

constexpr std::size_t kGapMin = 12;  // Between two columns.
constexpr std::size_t kGapMax = 30;
constexpr std::size_t kArrowExtra = 6;  // An arrow has so much besides its label.

class Drawing {
 public:
  Drawing(const Sequence& sequence, std::size_t indent, std::size_t width)
      : sequence_(sequence),
        columns_(sequence.columns.size()),
        indent_(indent),
        number_width_(sequence.number_title.size()) {
    for (const SequenceRow& row : sequence.rows) {
      times_ = times_ || !row.time.empty();
      time_width_ = std::max(time_width_, row.time.size());
      number_width_ = std::max(number_width_, row.number.size());
    }
    place_columns(width);
  }

  std::string text() {
    std::string out;
    if (columns_ == 0) return out;
    std::string names(columns_ > 1 || at(0) > 0 ? at(columns_ - 1) + 1 : 1, ' ');
    for (std::size_t c = 0; c < columns_; ++c) {
      const std::string& name = sequence_.columns[c];
      const std::size_t begin = at(c) - std::min(at(c), name.size() / 2);
      if (names.size() < begin + name.size()) names.resize(begin + name.size(), ' ');
      names.replace(begin, name.size(), name);
    }
    out += line(times_ ? "time" : "", sequence_.number_title, names);
    for (const SequenceRow& row : sequence_.rows) out += line(row.time, row.number, cells_of(row));
    return out;
  }

 private:
  void place_columns(std::size_t width) {
    if (columns_ == 0) return;
    std::size_t gap = kGapMin;
    for (const SequenceRow& row : sequence_.rows) {
      gap = std::max(gap, row.label.size() + kArrowExtra);
    }
    for (const std::string& name : sequence_.columns) gap = std::max(gap, name.size() + 2);
    gap = std::min(gap, kGapMax);
    left_ = sequence_.columns.front().size() / 2;
    const std::size_t taken = indent_ + time_width_ + number_width_ + 8 + left_;
    const std::size_t room = width > taken + 6 ? width - taken - 6 : 0;
    if (columns_ > 1) gap = std::min(gap, room / (columns_ - 1));
    gap_ = std::max(gap, kGapMin);
  }

  std::size_t at(std::size_t column) const { return left_ + column * gap_; }

  std::string line(const std::string& time, const std::string& number, const std::string& rest) {
    std::string out(indent_, ' ');
    if (times_) out += fmt::format("{:>{}}  ", time, time_width_);
    out += fmt::format("{:>{}}  {}", number, number_width_, rest);
    out.erase(out.find_last_not_of(' ') + 1);
    return out + '\n';
  }

  // Draws an arrow from one column to those of `targets` that are on one side of it.
  void draw(std::string& cells, std::size_t from, const std::vector<std::size_t>& targets,
            bool doubled) {
    const bool right = targets.front() > from;
    std::size_t farthest = targets.front();
    for (const std::size_t t : targets) {
      farthest = right ? std::max(farthest, t) : std::min(farthest, t);
    }
    const std::size_t begin = std::min(at(from), at(farthest)) + 1;
    const std::size_t end = std::max(at(from), at(farthest));
    for (std::size_t x = begin; x < end; ++x) {
      if (cells[x] == ' ') cells[x] = doubled ? '=' : '-';
    }
    for (const std::size_t t : targets) cells[right ? at(t) - 1 : at(t) + 1] = right ? '>' : '<';
  }

  // Writes the label over the first part of an arrow; returns false if it does not fit.
  bool put_label(std::string& cells, std::size_t from, std::size_t to, const std::string& label) {
    const std::size_t next = to > from ? from + 1 : from - 1;
    const std::size_t begin = std::min(at(from), at(next)) + 2;
    const std::size_t room = gap_ - 3;
    if (label.size() > room) return false;
    cells.replace(begin + (room - label.size()) / 2, label.size(), label);
    return true;
  }

  std::string cells_of(const SequenceRow& row) {
    std::string cells(at(columns_ - 1) + 1, ' ');
    for (std::size_t c = 0; c < columns_; ++c) cells[at(c)] = '|';
    const std::size_t from = row.from == kNoColumn ? columns_ : row.from;
    std::vector<std::size_t> left;
    std::vector<std::size_t> right;
    for (const std::size_t column : row.to) {
      if (column != from) (from < column ? right : left).push_back(column);
    }
    bool labelled = false;
    if (row.from == kNoColumn) {
      // From a sender without a column: the arrow ends where it arrives.
      for (const std::size_t c : left) cells[at(c)] = '*';
      if (left.empty()) cells += "  ";
    } else {
      for (const auto* side : {&left, &right}) {
        if (side->empty()) continue;
        draw(cells, from, *side, row.marked);
        labelled = labelled || put_label(cells, from, side->front(), row.label);
      }
      // To no known receiver, or nothing that is sent.
      if (left.empty() && right.empty() && !(row.sent && from + 1 == columns_)) {
        cells[at(from)] = '*';
      } else if (left.empty() && right.empty()) {
        cells += row.marked ? "==>" : "-->";
      }
    }
    if (!labelled) cells += "  " + row.label;
    if (!row.note.empty()) cells += "  [" + row.note + "]";
    if (row.marked) cells += "  <<<";
    return cells;
  }

  const Sequence& sequence_;
  const std::size_t columns_;
  const std::size_t indent_;
  std::size_t left_ = 0;
  std::size_t gap_ = kGapMin;
  std::size_t time_width_ = 4;
  std::size_t number_width_;
  bool times_ = false;
};

}  // namespace

std::string sequence_text(const Sequence& sequence, std::size_t indent, std::size_t width) {
  return Drawing(sequence, indent, width).text();
}

}  // namespace rubric::report
