// The lines of a text.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace rubric::fuzz {

/// Returns sizes in bytes of the lines of a text, without their ends; at least one.
inline std::vector<std::size_t> line_sizes(std::string_view text) {
  std::vector<std::size_t> out(1);
  for (const char c : text) {
    if (c == '\n') {
      out.push_back(0);
    } else {
      ++out.back();
    }
  }
  return out;
}

}  // namespace rubric::fuzz
