#include "conformance/oracle/report/chart.h"

#include <fmt/format.h>

#include <algorithm>

#include "conformance/oracle/report/words.h"

namespace rubric::report {
namespace {

using oracle::kNobody;
using Kind = oracle::Observation::Kind;

constexpr std::size_t kGapMin = 12;   // Between two columns.
constexpr std::size_t kGapMax = 30;
constexpr std::size_t kArrowExtra = 6;  // Of an arrow beside its label.

class Chart {
 public:
  Chart(const Scene& scene, const std::vector<std::size_t>& rows, std::size_t marked,
        std::size_t indent, std::size_t width)
      : scene_(scene), rows_(rows), marked_(marked), indent_(indent) {
    for (const std::size_t i : rows) {
      add_column(scene.sender(i));
      for (const std::uint16_t node : scene.receivers(i)) add_column(node);
    }
    std::sort(columns_.begin(), columns_.end(), [&](std::uint16_t a, std::uint16_t b) {
      return scene.column_rank(a) < scene.column_rank(b);
    });
    for (const std::size_t i : rows) {
      const oracle::Place& place = scene.run().seen[i].place;
      times_ = times_ || place.time_us >= 0;
      time_width_ = std::max(time_width_, seconds_text(place.time_us).size());
      frame_width_ = std::max(frame_width_, std::to_string(place.frame).size());
    }
    place_columns(width);
  }

  std::string text() {
    std::string out;
    if (columns_.empty()) return out;
    std::string names(columns_.back() > 0 ? at(columns_.size() - 1) + 1 : 1, ' ');
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::string& name = scene_.name(columns_[c]);
      const std::size_t begin = at(c) - std::min(at(c), name.size() / 2);
      if (names.size() < begin + name.size()) names.resize(begin + name.size(), ' ');
      names.replace(begin, name.size(), name);
    }
    out += line(times_ ? "time" : "", "frame", names);
    for (const std::size_t i : rows_) {
      const oracle::Place& place = scene_.run().seen[i].place;
      out += line(seconds_text(place.time_us), std::to_string(place.frame), row(i));
    }
    return out;
  }

 private:
  void add_column(std::uint16_t node) {
    if (node == kNobody) return;
    if (std::find(columns_.begin(), columns_.end(), node) == columns_.end()) {
      columns_.push_back(node);
    }
  }

  std::size_t column_of(std::uint16_t node) const {
    return static_cast<std::size_t>(std::find(columns_.begin(), columns_.end(), node) -
                                    columns_.begin());
  }

  void place_columns(std::size_t width) {
    if (columns_.empty()) return;
    std::size_t gap = kGapMin;
    for (const std::size_t i : rows_) gap = std::max(gap, scene_.label(i).size() + kArrowExtra);
    for (const std::uint16_t node : columns_) gap = std::max(gap, scene_.name(node).size() + 2);
    gap = std::min(gap, kGapMax);
    left_ = scene_.name(columns_.front()).size() / 2;
    const std::size_t taken = indent_ + time_width_ + frame_width_ + 8 + left_;
    const std::size_t room = width > taken + 6 ? width - taken - 6 : 0;
    if (columns_.size() > 1) gap = std::min(gap, room / (columns_.size() - 1));
    gap_ = std::max(gap, kGapMin);
  }

  std::size_t at(std::size_t column) const { return left_ + column * gap_; }

  std::string line(const std::string& time, const std::string& frame, const std::string& rest) {
    std::string out(indent_, ' ');
    if (times_) out += fmt::format("{:>{}}  ", time, time_width_);
    out += fmt::format("{:>{}}  {}", frame, std::max<std::size_t>(frame_width_, 5), rest);
    out.erase(out.find_last_not_of(' ') + 1);
    return out + '\n';
  }

  // An arrow from one column to those of `targets` that lie on one side of it.
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

  // Writes the label over the first part of an arrow; false if it does not fit.
  bool put_label(std::string& cells, std::size_t from, std::size_t to, const std::string& label) {
    const std::size_t next = to > from ? from + 1 : from - 1;
    const std::size_t begin = std::min(at(from), at(next)) + 2;
    const std::size_t room = gap_ - 3;
    if (label.size() > room) return false;
    cells.replace(begin + (room - label.size()) / 2, label.size(), label);
    return true;
  }

  std::string row(std::size_t i) {
    std::string cells(at(columns_.size() - 1) + 1, ' ');
    for (std::size_t c = 0; c < columns_.size(); ++c) cells[at(c)] = '|';
    const std::string label = scene_.label(i);
    const std::uint16_t sender = scene_.sender(i);
    std::vector<std::size_t> left;
    std::vector<std::size_t> right;
    const std::size_t from = sender == kNobody ? columns_.size() : column_of(sender);
    for (const std::uint16_t node : scene_.receivers(i)) {
      const std::size_t column = column_of(node);
      if (column != from) (from < column && sender != kNobody ? right : left).push_back(column);
    }
    bool labelled = false;
    if (sender == kNobody) {
      // From somebody without a column: it ends where it arrives.
      for (const std::size_t c : left) cells[at(c)] = '*';
      if (left.empty()) cells += "  ";
    } else {
      for (const auto* side : {&left, &right}) {
        if (side->empty()) continue;
        draw(cells, from, *side, i == marked_);
        labelled = labelled || put_label(cells, from, side->front(), label);
      }
      // To nobody that is known, or nothing that is sent.
      const Kind kind = scene_.run().seen[i].kind;
      const bool sent = kind == Kind::kRadio || kind == Kind::kSerial;
      if (left.empty() && right.empty() && !(sent && from + 1 == columns_.size())) {
        cells[at(from)] = '*';
      } else if (left.empty() && right.empty()) {
        cells += i == marked_ ? "==>" : "-->";
      }
    }
    if (!labelled) cells += "  " + label;
    if (i == marked_) cells += "  <<<";
    return cells;
  }

  const Scene& scene_;
  const std::vector<std::size_t>& rows_;
  std::size_t marked_;
  std::size_t indent_;
  std::vector<std::uint16_t> columns_;
  std::size_t left_ = 0;
  std::size_t gap_ = kGapMin;
  std::size_t time_width_ = 4;
  std::size_t frame_width_ = 1;
  bool times_ = false;
};

}  // namespace

std::string chart(const Scene& scene, const std::vector<std::size_t>& rows, std::size_t marked,
                  std::size_t indent, std::size_t width) {
  return Chart(scene, rows, marked, indent, width).text();
}

}  // namespace rubric::report
