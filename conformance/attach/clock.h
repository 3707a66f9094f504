// The clock of a target that nobody can turn, and how far its times may be off.
#pragma once

#include <chrono>

#include "conformance/runner/target.h"

namespace rubric::attach {

/// Real time in ticks of 1/1024 s since its start.
class RealClock {
 public:
  using Steady = std::chrono::steady_clock;

  void start() { start_ = Steady::now(); }
  runner::Ticks now() const { return tick_of(Steady::now()); }
  /// Of a moment that is not before the start; else 0.
  runner::Ticks tick_of(Steady::time_point moment) const;
  /// When this tick begins.
  Steady::time_point begin_of(runner::Ticks ticks) const;

 private:
  Steady::time_point start_ = Steady::now();
};

/// Measured once, in the first 200 ms that it is asked for: twice the worst delay with which this
/// host wakes a sleeping thread, at least 10 ticks. Early as well as late: times are compared with
/// others that were taken late.
runner::Tolerance tolerance_of_this_host();

}  // namespace rubric::attach
