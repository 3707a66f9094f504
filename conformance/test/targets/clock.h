// The clock of a target that cannot be turned, and the error of its times.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

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

/// Measures how late this host wakes a sleeping thread, in a thread of its own.
class DelayWatch {
 public:
  DelayWatch() : thread_([this] { watch(); }) {}
  ~DelayWatch();
  std::chrono::microseconds worst() const { return std::chrono::microseconds(worst_us_); }

 private:
  void watch();

  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> worst_us_{0};
  std::thread thread_;
};

/// Returns twice the worst delay with which this host wakes a sleeping thread, at least 10 ticks:
/// the worst one of 200 ms at the first use, or `seen`, if that is worse. It counts for early times
/// too, as times are compared with others that were taken late.
runner::Tolerance tolerance_of_this_host(std::chrono::microseconds seen = {});

}  // namespace rubric::targets
