// The width of text.
#pragma once

#include <cstddef>

namespace rubric::cli {

constexpr std::size_t kColumnsMin = 60;

/// Returns `asked` if it is not 0; else the width of the terminal that `fd` is, between 60 and 120;
/// else 100.
std::size_t columns(std::size_t asked, int fd);

}  // namespace rubric::cli
