// Reads .rtr text. The grammar is spec/trace/rtr.ebnf.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// An error in a trace.
struct Diagnostic {
  Place place;
  std::string text;
};

/// The file as far as it was understood, with all its errors in order of place.
struct Parsed {
  static constexpr std::size_t kDiagnosticsMax = 100;
  static constexpr std::size_t kLineBytesMax = 65536;

  std::string file_name;
  File file;
  std::vector<Diagnostic> diagnostics;
  std::size_t dropped = 0;  ///< Diagnostics beyond kDiagnosticsMax.

  bool ok() const { return diagnostics.empty(); }
  /// Returns a line "file:line:column: text" for each, and a last one if some were dropped.
  std::string errors() const;
};

/// Editors begin files with it; it is passed over.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Reads a whole file and checks it (check.h).
Parsed parse(std::string_view text, std::string_view file_name);
/// Checks the grammar alone: not names, values and the order of lines.
Parsed parse_syntax(std::string_view text, std::string_view file_name);

/// Reads lines of a case as print() writes them. Throws std::logic_error for anything else.
Case parse_lines(std::string_view text);

/// Reads a message alone, "join_reply(seq_num=3 ...)"; returns what is wrong, or nothing.
std::string parse_message(std::string_view text, Message& out);

}  // namespace rubric::trace
