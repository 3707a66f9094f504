// What captures miss of serial lines, by the numbers of hosts' packets and by what they miss of the
// air.
#pragma once

#include <cstddef>
#include <vector>

#include "conformance/check/identify/identity.h"

namespace rubric::check {

/// Frames of a serial line that are not in its capture.
struct LineLoss {
  bool any = false;      ///< Its numbers show that some are missing, or they would not show it.
  std::size_t most = 0;  ///< Else so many may be: what it would lose as the air does.
};

/// Returns these by tap.
std::vector<LineLoss> find_line_losses(const Run& run, const Identity& who, const Options& options);

/// Returns whether captures miss many frames of the air.
bool misses_many_of_air(const Identity& who, const Options& options);

}  // namespace rubric::check
