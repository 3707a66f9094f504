// Text templates with named holes, used by the emitters.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubricc {

using Holes = std::vector<std::pair<std::string_view, std::string>>;

/// Replaces each `<<name>>` of `text` by its value. A value with line breaks is indented like the
/// hole if the hole is alone on its line; a hole alone on its line whose value is empty takes the
/// line with it, but only `<<name?>>` can be empty. Throws std::logic_error for a hole without a
/// value, a value without a hole, and an empty value of a hole without `?`.
std::string fill(std::string_view text, const Holes& holes);

}  // namespace rubricc
