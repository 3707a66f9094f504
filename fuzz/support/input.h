// Takes numbers and byte ranges off a fuzz input. Any input is good: past its end numbers are 0.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "codec/runtime/bytes.h"

namespace rubric::fuzz {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  std::uint8_t u8() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_[0];
    rest_ = rest_.from(1);
    return value;
  }
  std::uint16_t u16() {
    const unsigned high = u8();
    return static_cast<std::uint16_t>(high << 8 | u8());
  }
  std::uint32_t u32() {
    const std::uint32_t high = u16();
    return high << 16 | u16();
  }
  /// Returns a number from 0 to n - 1; n from 1 to 256.
  std::size_t below(std::size_t n) { return u8() % n; }
  /// Returns the next `size` bytes, or as many as there are.
  Bytes bytes(std::size_t size) {
    const Bytes taken = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.from(taken.size());
    return taken;
  }
  Bytes rest() { return bytes(rest_.size()); }
  std::string_view text() {
    const Bytes all = rest();
    return {reinterpret_cast<const char*>(all.data()), all.size()};
  }
  bool at_end() const { return rest_.empty(); }

 private:
  Bytes rest_;
};

}  // namespace rubric::fuzz
