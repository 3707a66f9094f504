// Virtual time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>

namespace rubric::lawful {

/// Runs events in order of time and, at one time, in order of scheduling.
class Scheduler {
 public:
  std::int64_t now_us() const { return now_us_; }

  void at(std::int64_t time_us, std::function<void()> call) {
    due_.emplace(std::pair(time_us < now_us_ ? now_us_ : time_us, order_++), std::move(call));
  }
  void after(std::int64_t delay_us, std::function<void()> call) {
    at(now_us_ + delay_us, std::move(call));
  }
  void run_until(std::int64_t end_us) {
    while (!due_.empty() && due_.begin()->first.first <= end_us) {
      auto first = due_.extract(due_.begin());
      now_us_ = first.key().first;
      first.mapped()();
    }
    now_us_ = end_us;
  }

 private:
  std::map<std::pair<std::int64_t, std::uint64_t>, std::function<void()>> due_;
  std::int64_t now_us_ = 0;
  std::uint64_t order_ = 0;
};

}  // namespace rubric::lawful
