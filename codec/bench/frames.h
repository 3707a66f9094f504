// Input of the benchmarks: net_msg frames as a sink puts them on the serial line.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace rubric::bench {

/// Kinds of message bodies.
enum Mix : int { kUpdates = 0, kReadUpdates = 1, kSynaptic = 2, kMixed = 3 };
constexpr std::size_t kFrameCount = 1024;
using Frame = std::vector<std::uint8_t>;

inline Frame make_frame(int kind, std::mt19937& random) {
  Frame f(114);  // Stale bytes fill it up.
  for (std::uint8_t& byte : f) byte = static_cast<std::uint8_t>(random());
  f[6] = 0;  // From a mote.
  f[8] &= 1;
  f[12] = 3;
  f[13] = 10;
  const auto n = static_cast<std::uint8_t>(1 + random() % 10);
  switch (kind) {
    case kUpdates:
      f[14] = 35;
      f[15] = n;
      f[11] = static_cast<std::uint8_t>(4 + 4 * n);
      break;
    case kReadUpdates:
      f[14] = 36;
      f[11] = 7;
      break;
    case kSynaptic:
      f[12] = 1;
      f[13] = 11;
      f[11] = static_cast<std::uint8_t>(2 + 4 * n);
      break;
    default:  // An application's own.
      f[13] = 8;
      f[11] = 20;
      break;
  }
  return f;
}

inline std::vector<Frame> make_frames(int mix) {
  std::mt19937 random(7);
  std::vector<Frame> out;
  for (std::size_t i = 0; i < kFrameCount; ++i) {
    const int kind = mix == kMixed ? static_cast<int>(random() % 4) : mix;
    out.push_back(make_frame(kind, random));
  }
  return out;
}

}  // namespace rubric::bench
