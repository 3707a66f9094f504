// "Did you mean": the nearest of some names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rubric::reflect {

/// Returns the steps (insert, delete, replace, swap neighbours) from `a` to `b`.
int edit_distance(std::string_view a, std::string_view b);

/// Returns the nearest of `names`, or an empty text if none is near enough to be meant; the first
/// of several equally near ones.
std::string_view nearest(std::string_view word, const std::vector<std::string>& names);

/// Returns " (did you mean 'x'?)", or an empty text.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

}  // namespace rubric::reflect
