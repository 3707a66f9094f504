// Ends a fuzz target when its property does not hold.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace rubric::fuzz {

/// Ends the process, so that the engine keeps the input, unless `holds`.
inline void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", property);
  std::abort();
}

}  // namespace rubric::fuzz
