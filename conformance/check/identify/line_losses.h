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

/// Frames that are not in the captures.
struct Losses {
  std::vector<LineLoss> lines;  ///< By tap.
  bool many_of_air = false;     ///< Many frames of the air.
};

Losses find_losses(const Run& run, const Identity& who, const Options& options);

}  // namespace rubric::check
