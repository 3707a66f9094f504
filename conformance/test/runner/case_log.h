// The log of a case, as text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::runner {

/// Everything that a case gave and got back, in the order of time. It is kept as text until a
/// report needs its lines, which take many times as much memory.
class CaseLog {
 public:
  void add(std::string_view line) { (text_ += line) += '\n'; }
  void add(const trace::Line& line) { add(trace::print(line)); }
  void reserve(std::size_t size) { text_.reserve(size); }
  bool empty() const { return text_.empty(); }
  const std::string& text() const { return text_; }
  /// Returns the lines, as a case without a name.
  trace::Case read() const { return trace::parse_lines(text_); }
  friend bool operator==(const CaseLog&, const CaseLog&) = default;

 private:
  std::string text_;
};

}  // namespace rubric::runner
