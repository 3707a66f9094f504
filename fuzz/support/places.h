// Checks that the reported places of a compiler or parser are within the text that it read.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/support/require.h"
#include "spec/compiler/diagnostics.h"

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

/// Checks the mistakes in `file`: line 0 is the file as a whole, column 0 the line.
inline void places_are_within(const rubricc::Diagnostics& diagnostics, const std::string& file,
                              std::string_view text) {
  const std::vector<std::size_t> sizes = line_sizes(text);
  for (const rubricc::Diagnostic& one : diagnostics.sorted()) {
    require(!one.text.empty(), "a mistake is told");
    if (one.place.file != file) continue;
    const auto line = static_cast<std::size_t>(one.place.line);
    require(one.place.line >= 0 && line <= sizes.size(), "a mistake is in a line of the text");
    require(one.place.column >= 0, "a mistake is in a column");
    if (line == 0) continue;
    require(static_cast<std::size_t>(one.place.column) <= sizes[line - 1] + 1,
            "a mistake is in a column of its line");
  }
  require(diagnostics.empty() == diagnostics.print().empty(), "mistakes are printed");
}

}  // namespace rubric::fuzz
