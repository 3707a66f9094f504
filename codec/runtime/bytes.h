// Borrowed byte ranges, and loads and stores of numbers at any alignment. Freestanding C++14; on
// C++20 the ranges convert to and from std::span.
#pragma once

#include <assert.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__cplusplus) && __cplusplus >= 202002L && __STDC_HOSTED__ && !defined(__AVR__)
#include <span>
#define RUBRIC_HAS_SPAN 1
#endif

#define RUBRIC_INLINE inline __attribute__((always_inline))

namespace rubric {

/// A read-only range of bytes; copy it like a pointer.
class Bytes {
 public:
  constexpr Bytes() = default;
  constexpr Bytes(const uint8_t* data, size_t size) : data_(data), size_(size) {}
  template <size_t N>
  constexpr Bytes(const uint8_t (&array)[N]) : data_(array), size_(N) {}
#ifdef RUBRIC_HAS_SPAN
  constexpr Bytes(std::span<const uint8_t> span) : data_(span.data()), size_(span.size()) {}
  constexpr operator std::span<const uint8_t>() const { return {data_, size_}; }
#endif

  constexpr const uint8_t* data() const { return data_; }
  constexpr size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr const uint8_t* begin() const { return data_; }
  constexpr const uint8_t* end() const { return data_ + size_; }
  constexpr const uint8_t& operator[](size_t i) const { return data_[i]; }

  /// Returns the first `n` bytes; n <= size().
  constexpr Bytes first(size_t n) const { return Bytes(data_, n); }
  /// Returns all but the first `n` bytes; n <= size().
  constexpr Bytes from(size_t n) const { return Bytes(data_ + n, size_ - n); }
  /// Returns `n` bytes from `offset`; offset + n <= size().
  constexpr Bytes sub(size_t offset, size_t n) const { return Bytes(data_ + offset, n); }

 private:
  const uint8_t* data_ = nullptr;
  size_t size_ = 0;
};

/// Returns whether bytes and lengths are the same.
inline bool equal(Bytes a, Bytes b) {
  return a.size() == b.size() && (a.empty() || memcmp(a.data(), b.data(), a.size()) == 0);
}

/// A writable range of bytes.
class MutableBytes {
 public:
  constexpr MutableBytes() = default;
  constexpr MutableBytes(uint8_t* data, size_t size) : data_(data), size_(size) {}
  template <size_t N>
  constexpr MutableBytes(uint8_t (&array)[N]) : data_(array), size_(N) {}
#ifdef RUBRIC_HAS_SPAN
  constexpr MutableBytes(std::span<uint8_t> span) : data_(span.data()), size_(span.size()) {}
  constexpr operator std::span<uint8_t>() const { return {data_, size_}; }
#endif
  constexpr operator Bytes() const { return Bytes(data_, size_); }

  constexpr uint8_t* data() const { return data_; }
  constexpr size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr uint8_t& operator[](size_t i) const { return data_[i]; }
  constexpr MutableBytes first(size_t n) const { return MutableBytes(data_, n); }
  constexpr MutableBytes from(size_t n) const { return MutableBytes(data_ + n, size_ - n); }
  constexpr MutableBytes sub(size_t offset, size_t n) const {
    return MutableBytes(data_ + offset, n);
  }

 private:
  uint8_t* data_ = nullptr;
  size_t size_ = 0;
};

RUBRIC_INLINE constexpr uint8_t load_u8(const uint8_t* p) { return p[0]; }
RUBRIC_INLINE constexpr uint16_t load_be16(const uint8_t* p) {
  return static_cast<uint16_t>(static_cast<uint16_t>(p[0]) << 8 | p[1]);
}
RUBRIC_INLINE constexpr uint16_t load_le16(const uint8_t* p) {
  return static_cast<uint16_t>(static_cast<uint16_t>(p[1]) << 8 | p[0]);
}
RUBRIC_INLINE constexpr uint32_t load_be32(const uint8_t* p) {
  return static_cast<uint32_t>(p[0]) << 24 | static_cast<uint32_t>(p[1]) << 16 |
         static_cast<uint32_t>(p[2]) << 8 | p[3];
}
RUBRIC_INLINE constexpr uint32_t load_le32(const uint8_t* p) {
  return static_cast<uint32_t>(p[3]) << 24 | static_cast<uint32_t>(p[2]) << 16 |
         static_cast<uint32_t>(p[1]) << 8 | p[0];
}

RUBRIC_INLINE void store_u8(uint8_t* p, uint8_t v) { p[0] = v; }
RUBRIC_INLINE void store_be16(uint8_t* p, uint16_t v) {
  p[0] = static_cast<uint8_t>(v >> 8);
  p[1] = static_cast<uint8_t>(v);
}
RUBRIC_INLINE void store_le16(uint8_t* p, uint16_t v) {
  p[0] = static_cast<uint8_t>(v);
  p[1] = static_cast<uint8_t>(v >> 8);
}
RUBRIC_INLINE void store_be32(uint8_t* p, uint32_t v) {
  p[0] = static_cast<uint8_t>(v >> 24);
  p[1] = static_cast<uint8_t>(v >> 16);
  p[2] = static_cast<uint8_t>(v >> 8);
  p[3] = static_cast<uint8_t>(v);
}
RUBRIC_INLINE void store_le32(uint8_t* p, uint32_t v) {
  p[0] = static_cast<uint8_t>(v);
  p[1] = static_cast<uint8_t>(v >> 8);
  p[2] = static_cast<uint8_t>(v >> 16);
  p[3] = static_cast<uint8_t>(v >> 24);
}

/// Converts IEEE 754 binary32 from and to its bit pattern; NaN payloads survive.
RUBRIC_INLINE float float_of_bits(uint32_t bits) {
  float value;
  static_assert(sizeof(value) == sizeof(bits), "float must be binary32");
  memcpy(&value, &bits, sizeof(value));
  return value;
}
RUBRIC_INLINE uint32_t bits_of_float(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof(bits));
  return bits;
}

}  // namespace rubric
