#include "conformance/report/sequence_svg.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "codec/text/text.h"

namespace rubric::report {
namespace {

// In pixels. Fonts are monospaced, so that widths are known before drawing.
constexpr double kCharacter = 7.3;    // In a label, 12 px high.
constexpr double kSmall = 6.7;        // In a note, 11 px high.
constexpr double kStub = 34;          // An arrow that one end of has no column.
constexpr double kGapPixelsMin = 96;  // Between columns.
constexpr double kLabelRoom = 26;     // An arrow is longer than its label by this.
constexpr double kRowArrow = 31;
constexpr double kRowStub = 25;
constexpr double kPause = 16;  // For a long time.
constexpr double kHeadHeight = 38;
constexpr double kMargin = 10;
constexpr long long kPauseTicks = 100;  // A longer time is drawn as a pause.
constexpr std::size_t kDescribedMax = 60;

double length_of(std::string_view text, double character) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < text.size(); ++letters) {
    i += std::max<std::size_t>(text::utf8_length(text.substr(i)), 1);
  }
  return static_cast<double>(letters) * character;
}

long long number_of(const std::string& text) {
  long long number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

using Way = SequenceRow::Way;

const char* way_class(Way way) {
  switch (way) {
    case Way::kSerial: return " rc-serial";
    case Way::kPeis: return " rc-peis";
    case Way::kCall: return " rc-call";
    case Way::kRadio:
    case Way::kState: break;
  }
  return "";
}

// The columns between which a row is drawn: all its senders and receivers.
struct Span {
  std::size_t first = kNoColumn;
  std::size_t last = kNoColumn;
  bool single() const { return first == last; }
};

Span span_of(const SequenceRow& row) {
  std::vector<std::size_t> all = row.to;
  all.insert(all.end(), row.missed.begin(), row.missed.end());
  if (row.from != kNoColumn) all.push_back(row.from);
  if (all.empty()) return {};
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  return {*low, *high};
}

class Picture {
 public:
  Picture(const Sequence& sequence, const SvgWords& words)
      : sequence_(sequence), words_(words), columns_(sequence.columns.size()) {
    place();
  }

  std::string svg() {
    const double head = kMargin;
    double y = head + kHeadHeight + 8;
    std::string rows;
    long long before = 0;
    double from = head + kHeadHeight;
    for (std::size_t i = 0; i < sequence_.rows.size(); ++i) {
      const SequenceRow& row = sequence_.rows[i];
      const long long time = number_of(row.number);
      if (i > 0 && time - before > kPauseTicks) {
        lives(from, y + 5, "rc-life");
        lives(y + 5, y + 5 + kPause, "rc-pause");
        from = y + 5 + kPause;
        y += kPause;
      }
      y += span_of(row).single() ? kRowStub : kRowArrow;
      draw(row, y, i == 0 || time != before, rows);
      before = time;
    }
    y += 14;
    lives(from, y, "rc-life");
    std::string signs;
    y += legend(y, signs);
    std::string heads = head_row(head);
    if (words_.in_page) {
      heads = fmt::format(
          "<g class=\"rc-heads\"><rect class=\"rc-band\" width=\"100%\" "
          "height=\"{:.0f}\"/>{}</g>",
          head + kHeadHeight + 2, heads);
      return begin(y + kMargin) + lives_ + rows + signs + heads + "</svg>\n";
    }
    return begin(y + kMargin) + heads + signs + lives_ + rows + "</svg>\n";
  }

 private:
  // Places columns as far apart as the labels between them need.
  void place() {
    double time_width = length_of(sequence_.number_title, kSmall);
    for (const SequenceRow& row : sequence_.rows) {
      time_width = std::max(time_width, length_of(row.number, kSmall));
    }
    time_ = kMargin + time_width;
    std::vector<double> gap(columns_ > 1 ? columns_ - 1 : 0, kGapPixelsMin);
    for (std::size_t c = 0; c + 1 < columns_; ++c) {
      gap[c] = std::max(gap[c], (head_width(c) + head_width(c + 1)) / 2 + 12);
    }
    std::vector<const SequenceRow*> rows;
    for (const SequenceRow& row : sequence_.rows) rows.push_back(&row);
    std::stable_sort(rows.begin(), rows.end(), [](const auto* a, const auto* b) {
      const Span one = span_of(*a);
      const Span two = span_of(*b);
      return one.last - one.first < two.last - two.first;
    });
    for (const SequenceRow* row : rows) widen(*row, gap);
    const double first = columns_ == 0 ? 0 : std::max(head_width(0) / 2, kStub) + 16;
    x_.assign(columns_, time_ + first);
    for (std::size_t c = 1; c < columns_; ++c) x_[c] = x_[c - 1] + gap[c - 1];
    measure();
  }

  void widen(const SequenceRow& row, std::vector<double>& gap) const {
    Span span = span_of(row);
    if (span.first == kNoColumn) return;
    double needed = length_of(row.detail, kCharacter) + kLabelRoom;
    if (span.single()) {
      if (span.first + 1 >= columns_) return;
      needed += kStub;
      ++span.last;
    }
    double there = 0;
    for (std::size_t c = span.first; c < span.last; ++c) there += gap[c];
    if (there >= needed) return;
    const double more = (needed - there) / static_cast<double>(span.last - span.first);
    for (std::size_t c = span.first; c < span.last; ++c) gap[c] += more;
  }

  // Measures where notes begin, and the width of all.
  void measure() {
    double right = columns_ == 0 ? time_ : x_.back() + head_width(columns_ - 1) / 2;
    double notes = 0;
    for (const SequenceRow& row : sequence_.rows) {
      const Span span = span_of(row);
      if (span.single() && span.first != kNoColumn) {
        right = std::max(right, label_begin(row) + length_of(row.detail, kCharacter));
      }
      notes = std::max(notes, length_of(row.note, kSmall));
    }
    notes_ = right + 18;
    width_ = notes_ + notes + kMargin;
  }

  double head_width(std::size_t c) const {
    const std::string about = c < sequence_.about.size() ? sequence_.about[c] : "";
    return std::max(
        {44.0, length_of(sequence_.columns[c], kCharacter) + 18, length_of(about, 6.4) + 14});
  }

  // Returns where the label of a row with only one column begins.
  double label_begin(const SequenceRow& row) const {
    const bool leaves =
        row.from != kNoColumn && row.to.empty() && row.way != Way::kCall && row.way != Way::kState;
    return x_[span_of(row).first] + (leaves ? kStub + 10 : 10);
  }

  std::string begin(double height) const {
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"rubric-chart\" role=\"img\" "
        "aria-labelledby=\"{0}-title {0}-desc\" viewBox=\"0 0 {1:.0f} {2:.0f}\" width=\"{1:.0f}\" "
        "height=\"{2:.0f}\">\n<title id=\"{0}-title\">{3}</title>\n<desc id=\"{0}-desc\">{4}"
        "</desc>\n",
        text::xml_text(words_.id), width_, height, text::xml_text(words_.title),
        text::xml_text(description()));
    return words_.in_page ? out : fmt::format("{}<style>{}</style>\n", out, kSequenceStyle);
  }

  std::string name_of(std::size_t column) const { return sequence_.columns[column]; }

  // Returns the text for readers who do not see the picture.
  std::string description() const {
    std::string out = fmt::format("{} between {}.", text::counted(sequence_.rows.size(), "event"),
                                  fmt::join(sequence_.columns, ", "));
    if (words_.in_page || sequence_.rows.size() > kDescribedMax) return out;
    for (const SequenceRow& row : sequence_.rows) {
      std::vector<std::string> to;
      for (const std::size_t c : row.to) to.push_back(name_of(c));
      out += fmt::format(" {} {}: ", sequence_.number_title, row.number);
      if (row.from != kNoColumn) out += name_of(row.from) + (to.empty() ? ", " : " ");
      if (!to.empty()) out += fmt::format("to {}, ", fmt::join(to, " and "));
      out += row.detail;
      if (!row.note.empty()) out += " (" + row.note + ")";
      out += ';';
    }
    out.back() = '.';
    return out;
  }

  std::string head_row(double y) const {
    std::string out = fmt::format("<text class=\"rc-time\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                                  time_, y + kHeadHeight - 12, sequence_.number_title);
    for (std::size_t c = 0; c < columns_; ++c) {
      const double wide = head_width(c);
      const std::string about = c < sequence_.about.size() ? sequence_.about[c] : "";
      out += fmt::format(
          "<rect class=\"rc-head\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.0f}\" "
          "rx=\"5\"/>"
          "<text class=\"rc-name\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
          x_[c] - wide / 2, y, wide, kHeadHeight, x_[c], y + (about.empty() ? 23 : 16),
          text::xml_text(name_of(c)));
      if (!about.empty()) {
        out += fmt::format("<text class=\"rc-about\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x_[c],
                           y + 30, text::xml_text(about));
      }
      out += '\n';
    }
    return out;
  }

  void lives(double from, double to, const char* kind) {
    for (const double x : x_) {
      lives_ += fmt::format(
          "<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kind, x,
          x, from, to);
    }
    lives_ += '\n';
  }

  void draw(const SequenceRow& row, double y, bool tells_time, std::string& out) const {
    out += fmt::format("<g class=\"rc-row{}\" data-lines=\"{}\">", row.marked ? " rc-marked" : "",
                       fmt::join(row.lines, " "));
    if (words_.in_page) {
      const double height = span_of(row).single() ? kRowStub : kRowArrow;
      out += fmt::format("<rect class=\"rc-band\" y=\"{:.1f}\" width=\"100%\" height=\"{}\"/>",
                         y + 8 - height, height);
    } else {
      out += "<title>" + text::xml_text(row.full) + "</title>";
    }
    if (tells_time) {
      out += fmt::format("<text class=\"rc-time\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", time_,
                         y + 4, row.number);
    }
    const Span span = span_of(row);
    if (span.first == kNoColumn) {
      out += label(notes_ - 18 - length_of(row.detail, kCharacter), y + 4, row.detail, "");
    } else if (span.single()) {
      draw_stub(row, y, out);
    } else {
      draw_arrows(row, span, y, out);
    }
    if (!row.note.empty()) {
      out += fmt::format("<text class=\"rc-note\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", notes_,
                         y + 4, with_rules(row.note));
    }
    out += "</g>\n";
  }

  // Marks rules: words in capitals with a number, such as J4-SEQ.
  static std::string with_rules(const std::string& note) {
    std::string out;
    for (std::size_t i = 0; i < note.size();) {
      const std::size_t end = std::min(note.find(' ', i), note.size());
      std::string word = note.substr(i, end - i);
      const bool comma = word.ends_with(',');
      if (comma) word.pop_back();
      const bool rule = word.size() > 2 && word.find('-') != word.npos && word[0] >= 'A' &&
                        word[0] <= 'Z' && word[1] >= '0' && word[1] <= '9';
      out += rule ? "<tspan class=\"rc-rule\">" + text::xml_text(word) + "</tspan>"
                  : text::xml_text(word);
      if (comma) out += ',';
      if (end < note.size()) out += ' ';
      i = end + 1;
    }
    return out;
  }

  static std::string label(double x, double y, const std::string& text, const char* more) {
    return fmt::format("<text class=\"rc-label{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", more, x, y,
                       text::xml_text(text));
  }

  static std::string line(double x1, double x2, double y, const std::string& kind) {
    return fmt::format(
        "<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kind, x1,
        x2, y, y);
  }

  static std::string tip(double x, double y, bool right, bool open) {
    const int back = right ? -9 : 9;
    return fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}l{} -4v8z\"/>",
                       open ? "rc-open" : "rc-tip", x, y, back);
  }

  static std::string cross(double x, double y) {
    return fmt::format("<path class=\"rc-lost\" d=\"M{:.1f} {:.1f}l10 10m0 -10l-10 10\"/>", x - 5,
                       y - 5);
  }

  static bool ignores(const SequenceRow& row, std::size_t column) {
    return std::find(row.ignored_by.begin(), row.ignored_by.end(), column) != row.ignored_by.end();
  }

  static std::string line_class(const SequenceRow& row) {
    return std::string("rc-line") + way_class(row.way);
  }

  // Draws a row to or from a node without a column, or an event at one node.
  void draw_stub(const SequenceRow& row, double y, std::string& out) const {
    const double x = x_[span_of(row).first];
    if (row.way == Way::kState) {
      out += fmt::format(
          "<rect class=\"rc-open\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"9\" height=\"9\"/>", x - 4.5,
          y - 4.5);
    } else if (row.from != kNoColumn) {
      const double way = row.way == Way::kCall ? -kStub : kStub;
      const double end = x + way;
      out += line(x, end - way / 8.5, y, line_class(row)) +
             (row.absent ? cross(end, y) : tip(end, y, way > 0, false));
    } else {
      out += line(x - kStub, x - 4, y, line_class(row)) + tip(x, y, true, !row.ignored_by.empty());
    }
    out += label(label_begin(row), y + 4, row.detail, "");
  }

  void draw_arrows(const SequenceRow& row, const Span& span, double y, std::string& out) const {
    out += label((x_[span.first] + x_[span.last]) / 2, y - 6, row.detail, " rc-middle");
    const std::size_t from = row.from == kNoColumn ? span.first : row.from;
    for (const bool right : {false, true}) {
      double far = x_[from];
      const auto beyond = [&](std::size_t c) { return right ? c > from : c < from; };
      for (const std::size_t c : row.to) {
        if (beyond(c)) far = right ? std::max(far, x_[c]) : std::min(far, x_[c]);
      }
      if (far != x_[from]) out += line(x_[from], far + (right ? -4 : 4), y, line_class(row));
      for (const std::size_t c : row.to) {
        if (beyond(c)) out += tip(x_[c], y, right, ignores(row, c));
      }
    }
    for (const std::size_t c : row.missed) {
      const double end = x_[c] + (x_[c] > x_[from] ? -14 : 14);
      out += line(x_[from], end, y, line_class(row)) + cross(end, y);
    }
  }

  // Draws the legend of a picture with several kinds of lines; returns its height.
  double legend(double y, std::string& out) {
    std::vector<std::pair<Way, const char*>> kinds;
    for (const auto& [way, name] :
         {std::pair{Way::kRadio, "radio"}, {Way::kSerial, "serial line"}, {Way::kPeis, "PEIS"}}) {
      if (std::any_of(sequence_.rows.begin(), sequence_.rows.end(),
                      [w = way](const SequenceRow& row) { return row.way == w; })) {
        kinds.emplace_back(way, name);
      }
    }
    if (kinds.size() < 2) return 0;
    double x = time_ + 16;
    y += 22;
    for (const auto& [way, name] : kinds) {
      out += line(x, x + 36, y, std::string("rc-line") + way_class(way)) +
             fmt::format("<text class=\"rc-note\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 43,
                         y + 4, name);
      x += 60 + length_of(name, kSmall);
    }
    width_ = std::max(width_, x);
    return 28;
  }

  const Sequence& sequence_;
  const SvgWords& words_;
  const std::size_t columns_;
  std::vector<double> x_;
  double time_ = 0;
  double notes_ = 0;
  double width_ = 0;
  std::string lives_;
};

}  // namespace

std::string sequence_svg(const Sequence& sequence, const SvgWords& words) {
  return Picture(sequence, words).svg();
}

}  // namespace rubric::report
