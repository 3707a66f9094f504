// The parts of a line of a trace. They throw LineError.
#pragma once

#include <vector>

#include "conformance/trace/scanner.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

Line parse_line(Scanner& in);
/// One or more headers that stand in a line.
void parse_headers(Scanner& in, std::vector<Item>& out);
/// Behind the word "case".
Case parse_case(Scanner& in);
Message parse_message(Scanner& in);

}  // namespace rubric::trace
