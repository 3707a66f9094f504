// Scans one line of a trace, word by word.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Stops the reading of a line. Used inside the parser only.
struct LineError {
  Place place;
  std::string text;
};

class Scanner {
 public:
  Scanner(std::string_view text, std::uint32_t line) : text_(text), line_(line) {}

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool at_end() const { return at_ == text_.size(); }
  /// Returns the present character; 0 at the end.
  char peek() const { return at_end() ? '\0' : text_[at_]; }
  std::string_view rest() const { return text_.substr(at_); }
  void advance(std::size_t n) { at_ += n; }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  /// Returns the text up to the next blank or the end; perhaps empty.
  std::string_view word() {
    return until([](char c) { return c == ' ' || c == '\t'; });
  }
  /// Returns the text up to a character for which `stop` holds, or the end.
  template <typename Stop>
  std::string_view until(Stop stop) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !stop(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  Place place() const { return place_at(at_); }
  /// Returns the place of a part of the line.
  Place place_of(std::string_view part) const {
    return place_at(static_cast<std::size_t>(part.data() - text_.data()));
  }
  [[noreturn]] void fail(const std::string& text) const { throw LineError{place(), text}; }
  [[noreturn]] void fail_at(std::string_view part, const std::string& text) const {
    throw LineError{place_of(part), text};
  }

 private:
  Place place_at(std::size_t at) const { return {line_, static_cast<std::uint32_t>(at + 1)}; }

  std::string_view text_;
  std::size_t at_ = 0;
  std::uint32_t line_;
};

}  // namespace rubric::trace
