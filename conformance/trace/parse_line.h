// Parses one line of a case, and the parts of it that headers have, too.
#pragma once

#include <string>
#include <string_view>

#include "conformance/trace/scanner.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Returns `text` without blanks and tabs around it.
std::string_view trimmed(std::string_view text);
/// Returns the comment at the end of a line without its ';'; throws LineError for other text.
std::string parse_comment(Scanner& in);
/// Returns a message with its fields; throws LineError.
Message parse_message(Scanner& in);
/// Returns a line of a case; throws LineError.
Line parse_line(Scanner& in);

}  // namespace rubric::trace
