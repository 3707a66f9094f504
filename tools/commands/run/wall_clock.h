// The system's clock, as captures and tuples count time.
#pragma once

#include <chrono>
#include <cstdint>

namespace rubric::run {

/// Both count from 1970.
inline std::int64_t wall_ns() {
  return std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}
inline std::int64_t wall_ms() { return wall_ns() / 1'000'000; }

}  // namespace rubric::run
