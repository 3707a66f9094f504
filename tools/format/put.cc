#include "tools/format/put.h"

#include <charconv>
#include <cmath>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace rubric::format {
namespace {

constexpr char kHexDigits[] = "0123456789abcdef";

char* put_hex_portable(char* at, Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    *at++ = kHexDigits[byte >> 4];
    *at++ = kHexDigits[byte & 15];
  }
  return at;
}

#if defined(__x86_64__)
// Writes 32 digits from 16 bytes a step: each nibble looks its digit up.
__attribute__((target("ssse3"))) char* put_hex_ssse3(char* at, Bytes bytes) {
  const __m128i digits = _mm_loadu_si128(reinterpret_cast<const __m128i*>(kHexDigits));
  const __m128i low_nibbles = _mm_set1_epi8(15);
  std::size_t i = 0;
  for (; i + 16 <= bytes.size(); i += 16) {
    const __m128i raw = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes.data() + i));
    const __m128i high = _mm_and_si128(_mm_srli_epi16(raw, 4), low_nibbles);
    const __m128i low = _mm_and_si128(raw, low_nibbles);
    const __m128i high_digits = _mm_shuffle_epi8(digits, high);
    const __m128i low_digits = _mm_shuffle_epi8(digits, low);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(at), _mm_unpacklo_epi8(high_digits, low_digits));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(at + 16),
                     _mm_unpackhi_epi8(high_digits, low_digits));
    at += 32;
  }
  return put_hex_portable(at, bytes.from(i));
}
#endif

using PutHex = char* (*)(char*, Bytes);
PutHex choose_put_hex() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("ssse3")) return put_hex_ssse3;
#endif
  return put_hex_portable;
}
const PutHex kPutHex = choose_put_hex();

template <class T>
char* put_real(char* at, T value) {
  if (std::isnan(value)) return put(at, "\"NaN\"");
  if (std::isinf(value)) return value > 0 ? put(at, "\"Infinity\"") : put(at, "\"-Infinity\"");
  return std::to_chars(at, at + kMaxFloatChars, value).ptr;
}

}  // namespace

char* put_long_uint(char* at, std::uint64_t value) {
  char digits[kMaxIntChars];
  char* from = digits + kMaxIntChars;
  while (value >= 100) {
    from -= 2;
    put_pair(from, static_cast<std::uint32_t>(value % 100));
    value /= 100;
  }
  if (value >= 10) {
    from -= 2;
    put_pair(from, static_cast<std::uint32_t>(value));
  } else {
    *--from = static_cast<char>('0' + value);
  }
  const auto size = static_cast<std::size_t>(digits + kMaxIntChars - from);
  std::memcpy(at, from, size);
  return at + size;
}

char* put_float(char* at, std::uint32_t bits) { return put_real(at, float_of_bits(bits)); }
char* put_double(char* at, double value) { return put_real(at, value); }

char* put_time(char* at, std::int64_t time_ns) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  auto magnitude = static_cast<std::uint64_t>(time_ns);
  if (time_ns < 0) {
    *at++ = '-';
    magnitude = 0 - magnitude;
  }
  at = put_uint(at, magnitude / kSecond);
  std::uint64_t rest = magnitude % kSecond;
  if (rest == 0) return at;
  *at++ = '.';
  for (int i = 8; i >= 0; --i) {
    at[i] = static_cast<char>('0' + rest % 10);
    rest /= 10;
  }
  at += 9;
  while (at[-1] == '0') --at;
  return at;
}

char* put_hex(char* at, Bytes bytes) { return kPutHex(at, bytes); }

}  // namespace rubric::format
