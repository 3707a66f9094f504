// Finds the later lines of a case that depend on an earlier one.
#pragma once

#include <set>
#include <string>

#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Returns whether a line of the case counts its time from `line`, or names a variable that `line`
/// names. Without such a line the case can go on where the output that `line` asks for cannot be
/// seen.
bool is_needed_later(const trace::Case& one, const trace::Line& line);
/// Returns the variables that a line names.
std::set<std::string> names_of(const trace::Line& line);

}  // namespace rubric::runner
