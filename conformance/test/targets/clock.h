// The clock of a target that cannot be turned, and the error of its times.
#pragma once

#include <chrono>

#include "conformance/test/runner/target.h"

namespace rubric::targets {

/// Real time in ticks of 1/1024 s since its start.
class RealClock {
 public:
  using Steady = std::chrono::steady_clock;

  void start() { start_ = Steady::now(); }
  runner::Ticks now() const { return tick_of(Steady::now()); }
  /// Returns the tick of a moment; 0 if that is before the start.
  runner::Ticks tick_of(Steady::time_point moment) const;
  /// Returns when this tick begins.
  Steady::time_point begin_of(runner::Ticks ticks) const;

 private:
  Steady::time_point start_ = Steady::now();
};

/// Returns the tolerance, measured once in the first 200 ms of use: twice the worst delay with
/// which this host wakes a sleeping thread, at least 10 ticks. It counts for early times too, as
/// times are compared with others that were taken late.
runner::Tolerance tolerance_of_this_host();

}  // namespace rubric::targets
