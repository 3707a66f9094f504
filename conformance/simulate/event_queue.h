// Future events in the order of time; at equal times in the order of scheduling.
#pragma once

#include <cstddef>
#include <functional>
#include <queue>
#include <utility>

#include "codec/frame_generator/random.h"
#include "conformance/machine/ticks.h"

namespace rubric::simulate {

// The machine's units of time: the simulator counts microseconds since the start of the run, its
// nodes ticks.

using generate::Random;
using machine::kUsPerSecond;
using machine::Micros;
using machine::ticks_of;
using machine::us_of;

class EventQueue {
 public:
  using Work = std::function<void()>;

  Micros now() const { return now_us_; }
  void at(Micros time_us, Work work) {
    queue_.push({time_us < now_us_ ? now_us_ : time_us, count_++, std::move(work)});
  }
  void after(Micros delay_us, Work work) { at(now_us_ + delay_us, std::move(work)); }

  /// Runs everything that is due up to and including `end_us`, which is then the time.
  void run_until(Micros end_us) {
    while (!queue_.empty() && queue_.top().time_us <= end_us) {
      // The queue only lends its top; a moved item is popped at once.
      Item item = std::move(const_cast<Item&>(queue_.top()));
      queue_.pop();
      now_us_ = item.time_us;
      item.work();
    }
    if (now_us_ < end_us) now_us_ = end_us;
  }

 private:
  struct Item {
    Micros time_us = 0;
    std::size_t number = 0;
    Work work;
    bool operator<(const Item& other) const {  // priority_queue puts the greatest on top.
      return std::pair(time_us, number) > std::pair(other.time_us, other.number);
    }
  };
  std::priority_queue<Item> queue_;
  std::size_t count_ = 0;
  Micros now_us_ = 0;
};

}  // namespace rubric::simulate
