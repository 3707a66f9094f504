// Makes inputs of decode_fuzz that hold frames of a protocol's messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::fuzz {

/// How decode_fuzz reads its input's first byte.
enum class Format : std::uint8_t { kHdlc, kSf, kPcap, kPcapng, kHex };
inline constexpr std::size_t kFormats = 5;

/// Puts messages where the routes of a protocol (codec/generated/*/messages.h) say they go.
class MessageMaker {
 public:
  MessageMaker(const reflect::RouteTable& routes, unsigned seed) : routes_(routes), random_(seed) {}

  /// A frame that leads to the message of a random route, framed as `format` wants it. Routes of
  /// the radio only where the format carries radio frames.
  std::vector<std::uint8_t> framed(Format format);

  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

 private:
  std::vector<std::uint8_t> frame(const reflect::Route& route);
  std::size_t near_size(const reflect::Type& type, std::size_t room);
  std::vector<std::uint8_t> noise(std::size_t size);
  const reflect::Route& pick(bool radio);

  const reflect::RouteTable& routes_;
  std::minstd_rand random_;
};

}  // namespace rubric::fuzz
