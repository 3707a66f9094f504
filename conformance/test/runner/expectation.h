// Facts about the lines of a case: their times, and which later lines depend on one.
#pragma once

#include <set>
#include <string>

#include "conformance/test/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Returns whether breaking this line is weak: it names rules, and all of them are SHOULD.
bool is_weak(const trace::Line& line);

/// Returns whether a line of the case counts its time from `line`, or names a variable that `line`
/// names. Without such a line the case can go on where the output that `line` asks for cannot be
/// seen.
bool is_needed_later(const trace::Case& one, const trace::Line& line);
/// Returns the variables that a line names.
std::set<std::string> variables_of(const trace::Line& line);

}  // namespace rubric::runner
