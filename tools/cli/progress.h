// A progress bar on stderr for work that takes long.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace rubric::cli {

/// Shows nothing unless stderr is a terminal, stdout is none into which the data would run, and the
/// work takes a second.
class Progress {
 public:
  enum class Unit : std::uint8_t { kBytes, kCases };

  /// `total` of all input; 0 if unknown. `prints`: stdout is written to at the same time.
  Progress(std::uint64_t total, bool wanted, bool prints = true, Unit unit = Unit::kBytes);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::uint64_t units);
  /// Removes the bar, so that a message can be printed in its place.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(Clock::time_point now);

  std::string rate(double seconds) const;

  Unit unit_;
  bool active_;
  bool drawn_ = false;
  std::uint64_t total_;
  std::uint64_t done_ = 0;
  Clock::time_point start_;
  Clock::time_point next_;
};

}  // namespace rubric::cli
