#include "tools/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace rubric::cli {

Progress::Progress(std::uint64_t total, bool wanted, bool prints, Unit unit)
    : unit_(unit),
      active_(wanted && isatty(2) && !(prints && isatty(1))),
      total_(total),
      start_(Clock::now()),
      next_(start_ + std::chrono::seconds(1)) {}

Progress::~Progress() { clear(); }

void Progress::advance(std::uint64_t units) {
  done_ += units;
  if (!active_) return;
  const Clock::time_point now = Clock::now();
  if (now >= next_) draw(now);
}

std::string Progress::rate(double seconds) const {
  constexpr double kMega = 1e6;
  if (unit_ == Unit::kCases) return fmt::format("{} of {} cases", done_, total_);
  const double done = static_cast<double>(done_);
  return fmt::format("{:.0f} MB, {:.0f} MB/s", done / kMega, done / kMega / seconds);
}

void Progress::draw(Clock::time_point now) {
  constexpr int kWidth = 30;
  next_ = now + std::chrono::milliseconds(100);
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (total_ == 0) {
    fmt::print(stderr, "\r\033[K{}", rate(seconds));
  } else {
    const double part = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
    const int filled = static_cast<int>(part * kWidth);
    const double left = part > 0 ? seconds / part - seconds : 0;
    fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {:3.0f} %  {}, {:.0f} s left", "", filled, "",
               kWidth - filled, 100 * part, rate(seconds), left);
  }
  std::fflush(stderr);
}

void Progress::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

}  // namespace rubric::cli
