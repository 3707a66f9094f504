// What arrives in pieces, as lines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace rubric::run {

/// A line of more than `max` bytes is left out, to its end.
class LineSplitter {
 public:
  explicit LineSplitter(std::size_t max) : max_(max) {}

  /// Calls take(line) for each line, without its end, that ends in `more`; too_long() once for each
  /// line that is left out.
  template <class Take, class TooLong>
  void add(std::string_view more, const Take& take, const TooLong& too_long) {
    while (!more.empty()) {
      const std::size_t end = std::min(more.find('\n'), more.size());
      const bool was_too_long = waiting_.size() > max_;
      // One byte too many marks a line that is left out.
      waiting_ += more.substr(0, std::min(end, max_ + 1 - std::min(waiting_.size(), max_ + 1)));
      if (waiting_.size() > max_ && !was_too_long) too_long();
      if (end == more.size()) return;
      more.remove_prefix(end + 1);
      const std::string line = std::exchange(waiting_, {});
      if (line.size() <= max_) take(line);
    }
  }
  /// Returns the last line, which has no end, and begins anew; empty if there is none.
  std::string rest() {
    std::string line = std::exchange(waiting_, {});
    if (line.size() > max_) line.clear();
    return line;
  }

 private:
  std::size_t max_;
  std::string waiting_;
};

}  // namespace rubric::run
