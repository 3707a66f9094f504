// A progress bar on stderr for inputs that take long.
#pragma once

#include <chrono>
#include <cstdint>

namespace rubric::cli {

/// Shows nothing unless stderr is a terminal, stdout is none (the data would run into the bar), and
/// the work takes a second.
class Progress {
 public:
  /// `total_bytes` of all input; 0 where it is not known.
  Progress(std::uint64_t total_bytes, bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::uint64_t bytes);
  /// Takes the bar away, so that a message can stand in its place.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(Clock::time_point now);

  bool active_;
  bool drawn_ = false;
  std::uint64_t total_bytes_;
  std::uint64_t done_bytes_ = 0;
  Clock::time_point start_;
  Clock::time_point next_;
};

}  // namespace rubric::cli
