// Reads .rtr text line by line: the log of a run may be far longer than its headers.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "conformance/trace/parse.h"

namespace rubric::trace {

/// Takes a line of the last case of the file as it is so far: with all the headers that apply.
using TakeLine = std::function<void(const File& so_far, const Line& line)>;
/// Reads and checks a whole file as parse() does, and keeps of it only its cases' names and
/// headers, without their notes. Gives `take` each line in their order, up to the first mistake. A
/// header that comes too late, behind lines of its case, says nothing of those.
Parsed each_line(std::string_view text, std::string_view file_name, const TakeLine& take);

/// Reads again, without checking it, a case of a file that was right. `text` is that case alone,
/// from line `number` of the file on: what is parsed takes many times the memory of its text, so a
/// file of many cases is kept as text.
Case case_of(std::string_view text, std::uint32_t number);
/// Gives `take` the lines of such a case, and keeps nothing.
void lines_of(std::string_view text, const std::function<void(const Line&)>& take);

/// Is told of the cases of a file while they are read.
class Listener {
 public:
  virtual ~Listener() = default;
  /// A case begins: the last of the file.
  virtual void begin(const Case& one) = 0;
  /// The case has a header.
  virtual void header(const Header& one) = 0;
  /// The case has a line, which nobody keeps.
  virtual void line(const Line& one) = 0;
};
/// Checks the file of `parsed` while `read` adds to it and tells of its cases (check.h).
void check_as_read(Parsed& parsed, const std::function<void(Listener&)>& read);

}  // namespace rubric::trace
