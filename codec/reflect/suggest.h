// "Did you mean": the nearest of some names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rubric::reflect {

/// Steps (insert, delete, replace, swap neighbours) from `a` to `b`.
int edit_distance(std::string_view a, std::string_view b);

/// The nearest of `names`, or empty if none is near enough to be what was meant; the
/// first of them where several are as near.
std::string_view nearest(std::string_view word, const std::vector<std::string>& names);

/// " (did you mean 'x'?)", or empty.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

}  // namespace rubric::reflect
