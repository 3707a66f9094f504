// Check sums by carry-less multiplication.
#include "codec/containers/crc16_clmul.h"

#include "codec/containers/crc16_fast.h"

namespace rubric {

#if defined(__x86_64__)

using namespace clmul;

namespace {

// `size` is at least 16; `crc` may differ from 0 only if size is a multiple of 16.
template <bool kReflected>
RUBRIC_CLMUL std::uint16_t multiply_all(const std::uint8_t* p, std::size_t size,
                                        std::uint16_t crc) {
  const __m128i reverse = load128(kReverse);
  const std::size_t head = (size - 1) % 16 + 1;
  std::size_t blocks = (size + 15) / 16;
  __m128i block = _mm_shuffle_epi8(load128(p), load128(kReverse + 16 - head));
  if constexpr (kReflected) block = mirror(block);
  p += head;
  for (;;) {
    block = _mm_xor_si128(block, _mm_insert_epi16(_mm_setzero_si128(), crc, 7));
    const std::size_t group = (blocks - 1) % kGroup + 1;
    __m128i sum = multiply(block, group - 1);
    for (std::size_t behind = group - 1; behind-- != 0; p += 16) {
      block = _mm_shuffle_epi8(load128(p), reverse);
      if constexpr (kReflected) block = mirror(block);
      sum = _mm_xor_si128(sum, multiply(block, behind));
    }
    crc = reduce(sum);
    blocks -= group;
    if (blocks == 0) return crc;
    block = _mm_shuffle_epi8(load128(p), reverse);
    if constexpr (kReflected) block = mirror(block);
    p += 16;
  }
}

constexpr std::uint16_t mirror16(std::uint16_t value) {
  unsigned out = 0;
  for (unsigned bit = 0; bit < 16; ++bit) out |= (value >> bit & 1u) << (15 - bit);
  return static_cast<std::uint16_t>(out);
}

}  // namespace

std::uint16_t crc16_vector(Bytes bytes, std::uint16_t crc) {
  if (crc != 0) {
    const std::size_t head = bytes.size() % 16;
    crc = crc16_portable(bytes.first(head), crc);
    bytes = bytes.from(head);
  }
  if (bytes.size() < 16) return crc16_portable(bytes, crc);
  return multiply_all<false>(bytes.data(), bytes.size(), crc);
}

std::uint16_t fcs_vector(Bytes bytes) {
  if (bytes.size() < 16) return fcs_portable(bytes);
  return mirror16(multiply_all<true>(bytes.data(), bytes.size(), 0));
}

// Sixty-four bytes at a time, four blocks in one register.
namespace {

RUBRIC_WIDE std::uint16_t multiply_all_wide(const std::uint8_t* p, std::size_t size,
                                            std::uint16_t crc) {
  const __m512i reverse = _mm512_broadcast_i32x4(load128(kReverse));
  const std::size_t head = (size - 1) % 64 + 1;
  std::size_t chunks = (size + 63) / 64;
  // Masked bytes are not read at all, so the load may begin in front of the input.
  const __mmask64 mask = ~std::uint64_t{0} << (64 - head);
  __m512i chunk = _mm512_maskz_loadu_epi8(mask, p - (64 - head));
  p += head;
  for (;;) {
    chunk = _mm512_shuffle_epi8(chunk, reverse);
    const __m128i carried = _mm_insert_epi16(_mm_setzero_si128(), crc, 7);
    chunk = _mm512_xor_si512(chunk, _mm512_zextsi128_si512(carried));
    const std::size_t group = (chunks - 1) % (kGroup / 4) + 1;
    __m512i sum = multiply_wide(chunk, group - 1);
    for (std::size_t behind = group - 1; behind-- != 0; p += 64) {
      chunk = _mm512_shuffle_epi8(_mm512_loadu_si512(p), reverse);
      sum = _mm512_xor_si512(sum, multiply_wide(chunk, behind));
    }
    crc = reduce(add_lanes(sum));
    chunks -= group;
    if (chunks == 0) return crc;
    chunk = _mm512_loadu_si512(p);
    p += 64;
  }
}

}  // namespace

std::uint16_t crc16_wide(Bytes bytes, std::uint16_t crc) {
  if (crc != 0) {
    const std::size_t head = bytes.size() % 64;
    crc = crc16_portable(bytes.first(head), crc);
    bytes = bytes.from(head);
  }
  if (bytes.empty()) return crc;
  return multiply_all_wide(bytes.data(), bytes.size(), crc);
}

bool cpu_has(CpuPath path) {
  const bool vector = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("pclmul") &&
                      __builtin_cpu_supports("bmi");
  const bool wide = vector && __builtin_cpu_supports("bmi2") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                    __builtin_cpu_supports("avx512vbmi2") && __builtin_cpu_supports("vpclmulqdq");
  return path == CpuPath::kPortable || (path == CpuPath::kVector ? vector : wide);
}

#else

std::uint16_t crc16_vector(Bytes bytes, std::uint16_t crc) { return crc16_portable(bytes, crc); }
std::uint16_t crc16_wide(Bytes bytes, std::uint16_t crc) { return crc16_portable(bytes, crc); }
std::uint16_t fcs_vector(Bytes bytes) { return fcs_portable(bytes); }
bool cpu_has(CpuPath path) { return path == CpuPath::kPortable; }

#endif

}  // namespace rubric
