#include "codec/containers/byte_search.h"

#include <bit>
#include <cstring>

#include "codec/runtime/hdlc.h"

#if defined(__x86_64__)
#include <immintrin.h>
#if defined(__GNUC__) && !defined(__clang__)
// g++ 12 warns about its own AVX-512 intrinsics (GCC bug 105593).
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#endif

namespace rubric {
namespace {

constexpr std::uint64_t kOnes = 0x0101010101010101;
constexpr std::uint64_t kHighs = 0x8080808080808080;

// Returns the high bit of every byte that is zero, exact in the lowest such byte.
constexpr std::uint64_t zero_bytes(std::uint64_t v) { return (v - kOnes) & ~v & kHighs; }

bool is_special(std::uint8_t byte) { return byte == kHdlcFlag || byte == kHdlcEscape; }

const std::uint8_t* find_special_bytewise(const std::uint8_t* p, const std::uint8_t* end) {
  while (p != end && !is_special(*p)) ++p;
  return p;
}

}  // namespace

const std::uint8_t* find_special_swar(const std::uint8_t* begin, const std::uint8_t* end) {
  const std::uint8_t* p = begin;
  if constexpr (std::endian::native == std::endian::little) {
    for (; end - p >= 8; p += 8) {
      std::uint64_t word;
      std::memcpy(&word, p, sizeof(word));
      const std::uint64_t hits =
          zero_bytes(word ^ kOnes * kHdlcFlag) | zero_bytes(word ^ kOnes * kHdlcEscape);
      if (hits != 0) return p + std::countr_zero(hits) / 8;
    }
  }
  return find_special_bytewise(p, end);
}

#if defined(__SSE2__)

const std::uint8_t* find_special_portable(const std::uint8_t* begin, const std::uint8_t* end) {
  const std::uint8_t* p = begin;
  const __m128i flag = _mm_set1_epi8(kHdlcFlag);
  const __m128i escape = _mm_set1_epi8(kHdlcEscape);
  for (; end - p >= 16; p += 16) {
    const __m128i v = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
    const int hits =
        _mm_movemask_epi8(_mm_or_si128(_mm_cmpeq_epi8(v, flag), _mm_cmpeq_epi8(v, escape)));
    if (hits != 0) return p + std::countr_zero(static_cast<unsigned>(hits));
  }
  return find_special_swar(p, end);
}

#else

const std::uint8_t* find_special_portable(const std::uint8_t* begin, const std::uint8_t* end) {
  return find_special_swar(begin, end);
}

#endif

std::uint8_t* unescape_portable(const std::uint8_t* begin, const std::uint8_t* end,
                                std::uint8_t* out, bool* dangling) {
  const std::uint8_t* p = begin;
  *dangling = false;
  while (p != end) {
    const std::uint8_t* escape = find_special_portable(p, end);
    std::memcpy(out, p, static_cast<std::size_t>(escape - p));
    out += escape - p;
    if (escape == end) break;
    p = escape + 1;
    if (p == end) {
      *dangling = true;
      break;
    }
    *out++ = static_cast<std::uint8_t>(*p++ ^ kHdlcXor);
  }
  return out;
}

#if defined(__x86_64__)

#define RUBRIC_AVX2 __attribute__((target("avx2,bmi")))

RUBRIC_AVX2 const std::uint8_t* find_special_vector(const std::uint8_t* begin,
                                                    const std::uint8_t* end) {
  const std::uint8_t* p = begin;
  const __m256i flag = _mm256_set1_epi8(kHdlcFlag);
  const __m256i escape = _mm256_set1_epi8(kHdlcEscape);
  for (; end - p >= 32; p += 32) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    const __m256i hits = _mm256_or_si256(_mm256_cmpeq_epi8(v, flag), _mm256_cmpeq_epi8(v, escape));
    const auto mask = static_cast<unsigned>(_mm256_movemask_epi8(hits));
    if (mask != 0) return p + _tzcnt_u32(mask);
  }
  return find_special_portable(p, end);
}

__attribute__((target("avx512f,avx512bw,bmi,bmi2"))) const std::uint8_t* find_special_wide(
    const std::uint8_t* begin, const std::uint8_t* end) {
  const std::uint8_t* p = begin;
  const __m512i flag = _mm512_set1_epi8(kHdlcFlag);
  const __m512i escape = _mm512_set1_epi8(kHdlcEscape);
  for (; end - p >= 64; p += 64) {
    const __m512i v = _mm512_loadu_si512(p);
    const std::uint64_t hits = _mm512_cmpeq_epi8_mask(v, flag) | _mm512_cmpeq_epi8_mask(v, escape);
    if (hits != 0) return p + _tzcnt_u64(hits);
  }
  // Masked bytes are not read.
  const __mmask64 mask = _bzhi_u64(~std::uint64_t{0}, static_cast<unsigned>(end - p));
  const __m512i v = _mm512_maskz_loadu_epi8(mask, p);
  const std::uint64_t hits = _mm512_cmpeq_epi8_mask(v, flag) | _mm512_cmpeq_epi8_mask(v, escape);
  return hits != 0 ? p + _tzcnt_u64(hits) : end;
}

RUBRIC_AVX2 std::uint8_t* unescape_vector(const std::uint8_t* begin, const std::uint8_t* end,
                                          std::uint8_t* out, bool* dangling) {
  const std::uint8_t* p = begin;
  const __m256i escape = _mm256_set1_epi8(kHdlcEscape);
  while (end - p >= 34) {
    // Write all 32 bytes, then keep those up to the escape: saves the branch on its position.
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), v);
    const auto mask = static_cast<unsigned>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(v, escape)));
    if (mask == 0) {
      p += 32;
      out += 32;
      continue;
    }
    const unsigned at = _tzcnt_u32(mask);
    out[at] = static_cast<std::uint8_t>(p[at + 1] ^ kHdlcXor);
    p += at + 2;
    out += at + 1;
  }
  return unescape_portable(p, end, out, dangling);
}

#else

const std::uint8_t* find_special_vector(const std::uint8_t* begin, const std::uint8_t* end) {
  return find_special_portable(begin, end);
}
const std::uint8_t* find_special_wide(const std::uint8_t* begin, const std::uint8_t* end) {
  return find_special_portable(begin, end);
}
std::uint8_t* unescape_vector(const std::uint8_t* begin, const std::uint8_t* end, std::uint8_t* out,
                              bool* dangling) {
  return unescape_portable(begin, end, out, dangling);
}

#endif

}  // namespace rubric
