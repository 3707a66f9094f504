// Parses the parts of a line of a trace. These functions throw LineError.
#pragma once

#include <vector>

#include "conformance/trace/scanner.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

Line parse_line(Scanner& in);
/// Parses one or more headers in a line.
void parse_headers(Scanner& in, std::vector<Item>& out);
/// Parses the rest of a line after the word "case".
Case parse_case(Scanner& in);
Message parse_message(Scanner& in);

}  // namespace rubric::trace
