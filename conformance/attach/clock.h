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
  runner::Ticks now() const;
  /// When this tick begins.
  Steady::time_point begin_of(runner::Ticks ticks) const;

 private:
  Steady::time_point start_ = Steady::now();
};

/// Measured once, in the first 200 ms that it is asked for: how much later than asked for this
/// host wakes a sleeping thread, at worst, twice that and a tick for the rounding. Early: two
/// ticks, since a node's crystal and ours differ.
runner::Tolerance tolerance_of_this_host();

}  // namespace rubric::attach
