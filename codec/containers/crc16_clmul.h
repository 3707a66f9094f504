// Shared parts of all sums by carry-less multiplication; x86-64 only, empty elsewhere.
//
// Every block of 16 bytes is multiplied by a factor of its own, a power of x modulo the polynomial,
// so no product waits for another; the sum of the products, 80 bits, is reduced once.
#pragma once

#if defined(__x86_64__)

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#if defined(__GNUC__) && !defined(__clang__)
// g++ 12 warns about its own AVX-512 intrinsics (GCC bug 105593).
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#define RUBRIC_CLMUL __attribute__((target("pclmul,ssse3,sse4.1")))
#define RUBRIC_WIDE                                                                   \
  __attribute__((                                                                     \
      target("avx2,avx512f,avx512bw,avx512vl,avx512vbmi2,vpclmulqdq,pclmul,bmi,bmi2," \
             "popcnt")))

namespace rubric::clmul {

// The polynomial x^16 + x^12 + x^5 + 1; sums are remainders of message * x^16 by it.
inline constexpr std::uint64_t kPolynomial = 0x11021;

constexpr std::uint64_t power_of_x(unsigned exponent) {
  std::uint64_t rest = 1;
  for (unsigned i = 0; i < exponent; ++i) {
    rest <<= 1;
    if ((rest & 0x10000) != 0) rest ^= kPolynomial;
  }
  return rest;
}

// The integer part of x^64 / polynomial, 49 bits, for Barrett's reduction.
constexpr std::uint64_t barrett_quotient() {
  std::uint64_t quotient = 0;
  std::uint64_t rest = 0;
  for (int i = 64; i >= 0; --i) {
    rest = rest << 1 | (i == 64 ? 1u : 0u);
    quotient <<= 1;
    if ((rest & 0x10000) != 0) {
      rest ^= kPolynomial;
      quotient |= 1;
    }
  }
  return quotient;
}

// Blocks of 16 bytes that are multiplied side by side: enough for the longest serial frame.
inline constexpr std::size_t kGroup = 16;

// For the block that k blocks follow, at kGroup - 1 - k: x^(128k + 16) for its low half and
// x^(128k + 80) for its high half. Every block has its own factor, so no product waits for another.
struct Factors {
  alignas(64) std::uint64_t of[kGroup][2];
};
constexpr Factors make_factors() {
  Factors factors{};
  for (unsigned k = 0; k < kGroup; ++k) {
    factors.of[kGroup - 1 - k][0] = power_of_x(128 * k + 16);
    factors.of[kGroup - 1 - k][1] = power_of_x(128 * k + 80);
  }
  return factors;
}
inline constexpr Factors kFactors = make_factors();

// From kReverse + 16 - n: a shuffle that reverses the first n bytes, the last one lowest, and puts
// zeros above them. Zeros in front do not change a sum that starts at 0.
alignas(16) inline constexpr std::uint8_t kReverse[32] = {
    15,   14,   13,   12,   11,   10,   9,    8,    7,    6,    5,    4,    3,    2,    1,    0,
    0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80};

RUBRIC_CLMUL inline __m128i load128(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}

// Reverses every byte's bits: a reflected sum is the plain one of mirrored bytes, mirrored.
RUBRIC_CLMUL inline __m128i mirror(__m128i v) {
  const __m128i nibble = _mm_set1_epi8(0x0F);
  const __m128i mirrored_low = _mm_setr_epi8(
      0, static_cast<char>(0x80), 0x40, static_cast<char>(0xC0), 0x20, static_cast<char>(0xA0),
      0x60, static_cast<char>(0xE0), 0x10, static_cast<char>(0x90), 0x50, static_cast<char>(0xD0),
      0x30, static_cast<char>(0xB0), 0x70, static_cast<char>(0xF0));
  const __m128i low = _mm_shuffle_epi8(mirrored_low, _mm_and_si128(v, nibble));
  const __m128i high = _mm_shuffle_epi8(mirrored_low, _mm_and_si128(_mm_srli_epi16(v, 4), nibble));
  return _mm_or_si128(low, _mm_and_si128(_mm_srli_epi16(high, 4), nibble));
}

// Returns the remainder of an 80-bit sum of products.
RUBRIC_CLMUL inline std::uint16_t reduce(__m128i sum) {
  const __m128i fold = _mm_cvtsi64_si128(static_cast<long long>(power_of_x(64)));
  const __m128i mu = _mm_cvtsi64_si128(static_cast<long long>(barrett_quotient()));
  const __m128i polynomial = _mm_cvtsi64_si128(static_cast<long long>(kPolynomial));
  const __m128i value = _mm_xor_si128(sum, _mm_clmulepi64_si128(sum, fold, 0x01));
  const __m128i product = _mm_clmulepi64_si128(_mm_srli_epi64(value, 16), mu, 0x00);
  const __m128i quotient = _mm_srli_si128(product, 6);
  const __m128i rest = _mm_xor_si128(value, _mm_clmulepi64_si128(quotient, polynomial, 0x00));
  return static_cast<std::uint16_t>(_mm_extract_epi16(rest, 0));
}

RUBRIC_CLMUL inline __m128i multiply(__m128i block, std::size_t blocks_behind) {
  const __m128i factor = load128(kFactors.of[kGroup - 1 - blocks_behind]);
  return _mm_xor_si128(_mm_clmulepi64_si128(block, factor, 0x00),
                       _mm_clmulepi64_si128(block, factor, 0x11));
}

// Does the same for the four blocks of a chunk of 64 bytes that `chunks_behind` chunks follow.
RUBRIC_WIDE inline __m512i multiply_wide(__m512i chunk, std::size_t chunks_behind) {
  const __m512i factor = _mm512_loadu_si512(kFactors.of[kGroup - 4 - 4 * chunks_behind]);
  return _mm512_xor_si512(_mm512_clmulepi64_epi128(chunk, factor, 0x00),
                          _mm512_clmulepi64_epi128(chunk, factor, 0x11));
}

RUBRIC_WIDE inline __m128i add_lanes(__m512i sum) {
  const __m256i half =
      _mm256_xor_si256(_mm512_castsi512_si256(sum), _mm512_extracti64x4_epi64(sum, 1));
  return _mm_xor_si128(_mm256_castsi256_si128(half), _mm256_extracti128_si256(half, 1));
}

}  // namespace rubric::clmul

#endif  // __x86_64__
