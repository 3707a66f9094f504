#include "conformance/test/shrink/shrink.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "conformance/trace/check.h"

namespace rubric::shrink {
namespace {

using trace::Header;
using trace::Item;
using trace::Line;
using trace::Message;
using trace::Op;

// Returns the case's lines with the headers that apply to it: no comments, no blanks.
trace::File alone(const trace::File& file, const trace::Case& one) {
  trace::File out;
  const auto has_own = [&](std::size_t kind) {
    return std::any_of(one.items.begin(), one.items.end(), [&](const Item& item) {
      const Header* header = item.as<Header>();
      return header && header->what.index() == kind;
    });
  };
  const auto take = [&](const std::vector<Item>& items, bool of_file) {
    for (const Item& item : items) {
      const Header* header = item.as<Header>();
      if (!header || std::holds_alternative<trace::NoteHeader>(header->what)) continue;
      if (of_file && has_own(header->what.index())) continue;
      out.head.push_back(Header{header->what, "", header->place});
    }
  };
  take(file.head, true);
  take(one.items, false);
  trace::Case lines(one.name);
  lines.place = one.place;
  for (const Line* line : one.lines()) {
    Line copy = *line;
    copy.comment.clear();
    lines.add(std::move(copy));
  }
  out.cases.push_back(std::move(lines));
  return out;
}

bool names_variable(const trace::Value& value) {
  const bool range_of = value.is(trace::Value::Kind::kRange) && !value.text.empty();
  return value.is(trace::Value::Kind::kVariable) || range_of ||
         std::any_of(value.items.begin(), value.items.end(), names_variable);
}

class Shrinker {
 public:
  Shrinker(trace::File file, const StillShows& still_shows)
      : file_(std::move(file)), still_shows_(still_shows) {}

  bool shows(const trace::File& candidate) {
    if (!trace::check(candidate).empty()) return false;
    ++tried_;
    return still_shows_(candidate);
  }

  void run() {
    for (std::size_t before = size() + 1; size() < before;) {
      before = size();
      drop_lines();
      drop_each_line();
    }
    simplify_lines();
    drop_headers();
  }

  const trace::File& file() const { return file_; }
  std::size_t tried() const { return tried_; }
  std::size_t size() const { return file_.cases[0].items.size(); }

 private:
  bool try_it(trace::File candidate) {
    if (!shows(candidate)) return false;
    file_ = std::move(candidate);
    return true;
  }

  trace::File without(std::size_t from, std::size_t to) const {
    trace::File out = file_;
    auto& items = out.cases[0].items;
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(from),
                items.begin() + static_cast<std::ptrdiff_t>(to));
    return out;
  }

  // Tries ddmin's complements: pieces from a half down to single lines.
  void drop_lines() {
    std::size_t pieces = 2;
    while (size() >= 2 && pieces <= size()) {
      const std::size_t length = (size() + pieces - 1) / pieces;
      bool dropped = false;
      for (std::size_t from = 0; from < size() && !dropped; from += length) {
        dropped = try_it(without(from, std::min(from + length, size())));
      }
      if (dropped) {
        pieces = std::max<std::size_t>(2, pieces - 1);
      } else if (pieces == size()) {
        return;
      } else {
        pieces = std::min(size(), pieces * 2);
      }
    }
  }

  // Starts from the end, where lines that others count from have lost their successors; else these
  // count from the line that is then before them.
  void drop_each_line() {
    for (std::size_t i = size(); i-- > 0 && size() > 1;) {
      if (try_it(without(i, i + 1)) || line(i).label.empty()) continue;
      const std::string label = line(i).label;
      trace::File candidate = without(i, i + 1);
      for (Item& item : candidate.cases[0].items) {
        trace::Time& time = (*item.as<Line>()).time;
        if (time.base != trace::Time::Base::kLabel || time.label != label) continue;
        time.base = trace::Time::Base::kPrevious;
        time.label.clear();
      }
      try_it(std::move(candidate));
    }
  }

  template <class Edit>
  bool try_edit(std::size_t i, Edit edit) {
    trace::File candidate = file_;
    Line& line = (*candidate.cases[0].items[i].as<Line>());
    const Line before = line;
    edit(line);
    return !(line == before) && try_it(std::move(candidate));
  }
  const Line& line(std::size_t i) const { return (*file_.cases[0].items[i].as<Line>()); }

  void simplify_lines() {
    for (std::size_t i = 0; i < size(); ++i) {
      try_edit(i, [](Line& one) { one.label.clear(); });
      try_edit(i, [](Line& one) { one.am.reset(); });
      try_edit(i, [](Line& one) { one.bytes.reset(); });
      drop_fields(i);
      if (line(i).op == Op::kGiven) hurry(i);
    }
  }

  // Drops fields: a missing one is a wildcard in an expectation, and zero in a stimulus.
  void drop_fields(std::size_t i) {
    const bool fits = line(i).message.form == Message::Form::kFields;
    for (std::size_t f = line(i).message.fields.size(); fits && f-- > 0;) {
      try_edit(i, [f](Line& one) {
        auto& fields = one.message.fields;
        if (fields[f].path.empty()) return;  // Its place among the others is its name.
        // Zero may or may not equal the variable's value.
        if (one.op == Op::kGiven && names_variable(fields[f].value)) return;
        fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(f));
        one.message.open = true;
      });
    }
  }

  // Moves a stimulus as early as possible, by bisection.
  void hurry(std::size_t i) {
    if (!line(i).time.exact()) return;
    std::int64_t low = 0;
    std::int64_t high = line(i).time.from;
    while (low < high) {
      const std::int64_t middle = low + (high - low) / 2;
      const bool sooner = try_edit(i, [middle](Line& one) {
        one.time.from = middle;
        one.time.to = middle;
      });
      if (sooner) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
  }

  void drop_headers() {
    for (std::size_t i = file_.head.size(); i-- > 0;) {
      const auto& what = (*file_.head[i].as<Header>()).what;
      if (std::holds_alternative<trace::VersionHeader>(what) ||
          std::holds_alternative<trace::ProfileHeader>(what)) {
        continue;
      }
      trace::File candidate = file_;
      candidate.head.erase(candidate.head.begin() + static_cast<std::ptrdiff_t>(i));
      try_it(std::move(candidate));
    }
  }

  trace::File file_;
  const StillShows& still_shows_;
  std::size_t tried_ = 0;
};

}  // namespace

Shrunk shrink(const trace::File& file, const trace::Case& one, const StillShows& still_shows) {
  Shrunk out;
  Shrinker shrinker(alone(file, one), still_shows);
  if (shrinker.shows(shrinker.file())) {
    out.lines_before = shrinker.size();
    shrinker.run();
  }
  out.file = shrinker.file();
  out.lines = shrinker.size();
  out.tried = shrinker.tried();
  return out;
}

}  // namespace rubric::shrink
