// What later lines of a case take from an earlier one.
#pragma once

#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Whether a line of the case counts its time from `line`, or names a variable that `line` names.
/// Without such a line the case can go on where what `line` asks for cannot be seen.
bool is_needed_later(const trace::Case& one, const trace::Line& line);

}  // namespace rubric::runner
