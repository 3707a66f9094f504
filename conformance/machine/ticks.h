// Virtual time and its relation to microseconds: nodes count binary milliseconds, captures, the
// simulator and the checker count microseconds.
#pragma once

#include <cstdint>

namespace rubric::machine {

/// Virtual time in ticks of the profile: binary milliseconds, 1024 to the second.
using Ticks = std::uint32_t;
/// Time in microseconds, since any moment.
using Micros = std::int64_t;

inline constexpr Micros kUsPerSecond = 1'000'000;
inline constexpr Micros kTicksPerSecond = 1024;

/// Returns the tick that has begun at `time`, counted in units of which `per_second` make a second.
/// Of times whose ticks do not fit, the lower bits.
constexpr Ticks ticks_of(std::int64_t time, std::int64_t per_second = kUsPerSecond) {
  // Whole seconds are converted by themselves, as 1024 times a capture's time may overflow.
  return static_cast<Ticks>(time / per_second * kTicksPerSecond +
                            time % per_second * kTicksPerSecond / per_second);
}

/// Returns the fewest ticks that last at least `us` microseconds.
constexpr Ticks ticks_to_hold(Micros us) {
  return static_cast<Ticks>((us * kTicksPerSecond + kUsPerSecond - 1) / kUsPerSecond);
}

/// Returns the first whole microsecond of a tick: ticks_of(us_of(t)) == t.
constexpr Micros us_of(Ticks ticks) {
  return (ticks * kUsPerSecond + kTicksPerSecond - 1) / kTicksPerSecond;
}

}  // namespace rubric::machine
