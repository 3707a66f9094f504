// Checks whether the message of a line is possible there and in that direction.
#pragma once

#include <functional>
#include <string>
#include <unordered_set>

#include "conformance/trace/trace.h"

namespace rubric::trace {

using Report = std::function<void(Place, std::string)>;
/// Variables of the case that some line before this one has bound.
using BoundNames = std::unordered_set<std::string>;

/// Reports errors, and adds the variables that the line binds.
void check_message(const Line& line, LinkKind link, BoundNames& bound, const Report& report);

}  // namespace rubric::trace
