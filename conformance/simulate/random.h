// The only source of chance in a run: the same seed gives the same run on every machine.
#pragma once

#include <cstdint>

namespace rubric::simulate {

/// SplitMix64. (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, 2014)
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return z ^ (z >> 31);
  }
  /// Returns a number from `least` to `most`, both included.
  std::int64_t between(std::int64_t least, std::int64_t most) {
    const auto width = static_cast<std::uint64_t>(most - least) + 1;
    return least + static_cast<std::int64_t>(width == 0 ? next() : next() % width);
  }
  /// Returns true with probability `p`. Draws even if it is 0 or 1, so that a fault which is
  /// switched on leaves the rest of the run unchanged for as long as it can.
  bool chance(double p) { return static_cast<double>(next() >> 11) * 0x1p-53 < p; }

 private:
  std::uint64_t state_;
};

}  // namespace rubric::simulate
