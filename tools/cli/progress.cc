#include "tools/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace rubric::cli {

Progress::Progress(std::uint64_t total_bytes, bool wanted)
    : active_(wanted && isatty(2) && !isatty(1)),
      total_bytes_(total_bytes),
      start_(Clock::now()),
      next_(start_ + std::chrono::seconds(1)) {}

Progress::~Progress() { clear(); }

void Progress::advance(std::uint64_t bytes) {
  done_bytes_ += bytes;
  if (!active_) return;
  const Clock::time_point now = Clock::now();
  if (now >= next_) draw(now);
}

void Progress::draw(Clock::time_point now) {
  constexpr int kWidth = 30;
  constexpr double kMega = 1e6;
  next_ = now + std::chrono::milliseconds(100);
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double done = static_cast<double>(done_bytes_);
  const std::string rate = fmt::format("{:.0f} MB, {:.0f} MB/s", done / kMega,
                                       done / kMega / seconds);
  if (total_bytes_ == 0) {
    fmt::print(stderr, "\r\033[K{}", rate);
  } else {
    const double part = std::min(1.0, done / static_cast<double>(total_bytes_));
    const int filled = static_cast<int>(part * kWidth);
    const double left = part > 0 ? seconds / part - seconds : 0;
    fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {:3.0f} %  {}, {:.0f} s left", "", filled, "",
               kWidth - filled, 100 * part, rate, left);
  }
  std::fflush(stderr);
}

void Progress::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

}  // namespace rubric::cli
