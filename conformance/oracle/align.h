// Captures of one run that were recorded apart: one clock, or at least one order, for all.
#pragma once

#include <cstdint>
#include <limits>

#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// Stamp of what has none, while a run is put together.
constexpr std::int64_t kNoStamp = std::numeric_limits<std::int64_t>::min();

struct AlignOptions {
  bool enabled = true;
  std::int64_t skew_us = 50'000;       ///< Clocks that differ by no more are left as they are.
  std::int64_t response_us = 292'969;  ///< In which a sink forwards: 300 ticks (decision 125).
};

/// Puts the captures of `run` on the clock of the first one that has stamps, where the frames that
/// two of them share show that their clocks differ; Run::facts says what was done, or why not.
/// Stamps are those of the files, kNoStamp where there are none; `seen` is in the order of files.
/// Lines of .rtr logs keep their times (decision 9).
void align(Run& run, const AlignOptions& options);

}  // namespace rubric::oracle
