// What captures miss of serial lines, by the numbers of hosts' packets and by what they miss of the
// air, and of the link's copies.
#pragma once

#include <cstddef>
#include <cstdint>
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
  std::size_t copies = 0;       ///< So many of the link's copies in joins; no DSN shows them.
};

Losses find_losses(const Run& run, const Identity& who, const Options& options);

/// Returns whether the line of a sink that is captured with the air may miss more than it shows by
/// numbers: of what passed the sink while the line was recorded, not little is on the air alone.
/// A sink may have lost what no link acknowledgement shows it to have received.
bool misses_passed(const Run& run, const Identity& who, std::uint16_t sink);

}  // namespace rubric::check
