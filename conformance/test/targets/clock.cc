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
  using Steady = RealClock::Steady;
  microseconds worst{0};
  for (const auto end = Steady::now() + kMeasured; Steady::now() < end;) {
    const auto wanted = Steady::now() + kNap;
    std::this_thread::sleep_until(wanted);
    worst = std::max(worst, std::chrono::duration_cast<microseconds>(Steady::now() - wanted));
  }
  return worst;
}

}  // namespace

Ticks RealClock::tick_of(Steady::time_point moment) const {
  const auto passed = std::chrono::duration_cast<microseconds>(moment - start_);
  return machine::ticks_of(std::max<std::int64_t>(passed.count(), 0));
}

RealClock::Steady::time_point RealClock::begin_of(Ticks ticks) const {
  return start_ + microseconds(machine::us_of(ticks));
}

runner::Tolerance tolerance_of_this_host() {
  static const microseconds delay = worst_delay();
  const Ticks ticks = std::max(kLeastTicks, machine::ticks_to_hold(2 * delay.count()) + 1);
  return {ticks, ticks};
}

}  // namespace rubric::targets
