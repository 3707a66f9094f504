// Facts about the lines of a case: their times, and which later lines depend on one.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Returns whether breaking this line is weak: it names rules, and all of them are SHOULD.
bool is_weak(const trace::Line& line);

/// Returns whether a line of the case counts its time from `line`, or names a variable that `line`
/// names. Without such a line the case can go on where the output that `line` asks for cannot be
/// seen.
bool is_needed_later(const trace::Case& one, const trace::Line& line);
/// Returns the rules of `stimulus`, or of the start if it is null: those of the first line after it
/// that judges the node, else of the last one before it, else of the first that judges any node.
std::vector<std::string> rules_of_stimulus(const trace::Case& one, const trace::Line* stimulus,
                                           std::string_view node);
/// Returns whether a time of the case has this parameter.
bool uses(const trace::Case& one, trace::ParameterId parameter);
/// Returns the variables that a line names.
std::set<std::string> variables_of(const trace::Line& line);

}  // namespace rubric::runner
