// Virtual time. The simulator counts microseconds, the nodes binary milliseconds.
#pragma once

#include <cstdint>

#include "conformance/machine/profile.h"

namespace rubric::simulator {

/// Since the start of the run.
using Micros = std::int64_t;

inline constexpr Micros kUsPerSecond = 1'000'000;
inline constexpr Micros kTicksPerSecond = 1024;

/// The tick that has begun at `us`.
constexpr machine::Ticks ticks_of(Micros us) {
  return static_cast<machine::Ticks>(us * kTicksPerSecond / kUsPerSecond);
}
/// The first microsecond of a tick: ticks_of(us_of(t)) == t.
constexpr Micros us_of(machine::Ticks ticks) {
  return (ticks * kUsPerSecond + kTicksPerSecond - 1) / kTicksPerSecond;
}

}  // namespace rubric::simulator
