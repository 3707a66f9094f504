// Writes numbers and text at a place that has room for them, and returns its end.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

#include "codec/runtime/bytes.h"

namespace rubric::format {

inline constexpr char kDigitPairs[] =
    "00010203040506070809101112131415161718192021222324252627282930313233343536373839"
    "40414243444546474849505152535455565758596061626364656667686970717273747576777879"
    "8081828384858687888990919293949596979899";

/// Most characters that put_uint and put_int write.
inline constexpr std::size_t kMaxIntChars = 20;
/// Most characters that put_float and put_double write, quotes included.
inline constexpr std::size_t kMaxFloatChars = 32;
/// Most characters that put_time writes.
inline constexpr std::size_t kMaxTimeChars = 32;

template <std::size_t N>
RUBRIC_INLINE char* put(char* at, const char (&literal)[N]) {
  std::memcpy(at, literal, N - 1);
  return at + N - 1;
}
RUBRIC_INLINE char* put(char* at, std::string_view text) {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

/// Writes numbers beyond five digits; out of line.
char* put_long_uint(char* at, std::uint64_t value);

RUBRIC_INLINE char* put_pair(char* at, std::uint32_t pair) {
  std::memcpy(at, kDigitPairs + 2 * pair, 2);
  return at + 2;
}
RUBRIC_INLINE char* put_uint(char* at, std::uint64_t value) {
  if (value >= 10'000) {
    if (value >= 100'000) return put_long_uint(at, value);
    const auto five = static_cast<std::uint32_t>(value);
    *at = static_cast<char>('0' + five / 10'000);
    const std::uint32_t rest = five % 10'000;
    return put_pair(put_pair(at + 1, rest / 100), rest % 100);
  }
  const auto small = static_cast<std::uint32_t>(value);
  if (small < 10) {
    *at = static_cast<char>('0' + small);
    return at + 1;
  }
  if (small < 100) return put_pair(at, small);
  if (small < 1000) {
    *at = static_cast<char>('0' + small / 100);
    return put_pair(at + 1, small % 100);
  }
  return put_pair(put_pair(at, small / 100), small % 100);
}
RUBRIC_INLINE char* put_int(char* at, std::int64_t value) {
  if (value >= 0) return put_uint(at, static_cast<std::uint64_t>(value));
  *at++ = '-';
  return put_uint(at, std::uint64_t{0} - static_cast<std::uint64_t>(value));
}

/// Writes the shortest text that reads back as the same number; "NaN", "Infinity" and "-Infinity"
/// with quotes, since JSON has no such numbers.
char* put_float(char* at, std::uint32_t bits);
char* put_double(char* at, double value);

/// Writes nanoseconds as seconds, with as many digits as needed to be exact: "0.5", "12",
/// "-1.000001".
char* put_time(char* at, std::int64_t time_ns);

/// Writes two lower-case hex digits a byte.
char* put_hex(char* at, Bytes bytes);

}  // namespace rubric::format
