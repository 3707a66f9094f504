#include "conformance/test/targets/clock.h"

#include <algorithm>
#include <thread>

namespace rubric::targets {
namespace {

using runner::Ticks;
using std::chrono::microseconds;

constexpr microseconds kMeasured{200'000};
constexpr microseconds kNap{1000};
constexpr Ticks kLeastTicks = 10;

microseconds worst_delay() {
  const DelayWatch watch;
  std::this_thread::sleep_for(kMeasured);
  return watch.worst();
}

}  // namespace

DelayWatch::~DelayWatch() {
  stop_ = true;
  thread_.join();
}

void DelayWatch::watch() {
  while (!stop_) {
    const auto wanted = RealClock::Steady::now() + kNap;
    std::this_thread::sleep_until(wanted);
    const auto late = RealClock::Steady::now() - wanted;
    worst_us_ = std::max(worst_us_.load(), std::chrono::duration_cast<microseconds>(late).count());
  }
}

Ticks RealClock::tick_of(Steady::time_point moment) const {
  const auto passed = std::chrono::duration_cast<microseconds>(moment - start_);
  return machine::ticks_of(std::max<std::int64_t>(passed.count(), 0));
}

RealClock::Steady::time_point RealClock::begin_of(Ticks ticks) const {
  return start_ + microseconds(machine::us_of(ticks));
}

runner::Tolerance tolerance_of_this_host(microseconds seen) {
  static const microseconds measured = worst_delay();
  const microseconds delay = std::max(measured, seen);
  const Ticks ticks = std::max(kLeastTicks, machine::ticks_to_hold(2 * delay.count()) + 1);
  return {ticks, ticks};
}

}  // namespace rubric::targets
