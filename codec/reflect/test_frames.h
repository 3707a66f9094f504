// Frames to compare both decoders on: captured ones, and made-up ones near real ones (as
// spec/kaitai_check/frames.js makes them), mutated where parsers go wrong. Seeded.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// The bytes from the dispatch byte or the frame control field on.
struct TestFrame {
  bool radio = false;
  std::vector<std::uint8_t> bytes;
};

/// Returns all frames of the serial streams, serial forwarder streams and capture files below
/// `folder`.
std::vector<TestFrame> captured_frames(const std::string& folder);

std::string hex(const std::vector<std::uint8_t>& bytes);

class FrameMaker {
 public:
  FrameMaker(std::vector<TestFrame> real, const Protocol& protocol, std::uint64_t seed);

  TestFrame make();

 private:
  /// The end of a frame's headers, where its message begins.
  struct Shape {
    const Type* carrier;
    bool radio;
    std::size_t head_bytes;
  };

  std::size_t below(std::size_t n) { return random_() % n; }
  bool chance(int percent) { return below(100) < static_cast<std::size_t>(percent); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }
  template <std::size_t kCount>
  int one_of(const int (&values)[kCount]) {
    return values[below(kCount)];
  }

  TestFrame carried(const Shape& shape, int am_type, const std::vector<std::uint8_t>& message);
  std::vector<std::uint8_t> net_msg();
  TestFrame other_type(const Shape& shape);
  void mutate(TestFrame& frame, std::size_t head_bytes);
  void change(TestFrame& frame, std::size_t head_bytes);

  std::vector<TestFrame> real_;
  std::vector<Shape> shapes_;
  std::mt19937_64 random_;
};

}  // namespace rubric::reflect
