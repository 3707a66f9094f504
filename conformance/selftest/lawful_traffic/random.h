// Random numbers that are the same with every library and compiler.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rubric::lawful {

/// SplitMix64. Standard engines would do, but not standard distributions, whose results differ
/// between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// Returns a number from 0 to n - 1; n > 0.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(next() % n); }
  /// Returns a number from `low` to `high`, both included.
  std::int64_t between(std::int64_t low, std::int64_t high) {
    const auto span = static_cast<std::uint64_t>(high - low) + 1;
    return low + static_cast<std::int64_t>(next() % span);
  }
  bool chance(int percent) { return below(100) < static_cast<std::size_t>(percent); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(next() >> 32); }
  std::uint16_t number16() { return static_cast<std::uint16_t>(next() >> 32); }

 private:
  std::uint64_t state_;
};

}  // namespace rubric::lawful
