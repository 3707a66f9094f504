#include "codec/containers/frame_scan.h"

#include "codec/containers/byte_search.h"
#include "codec/containers/crc16_clmul.h"
#include "codec/runtime/hdlc.h"

namespace rubric {

#if defined(__x86_64__)

using namespace clmul;

namespace {

using Pointer = const std::uint8_t*;

constexpr std::ptrdiff_t kReach = kScanReach;

#define RUBRIC_VECTOR __attribute__((target("avx2,bmi,pclmul,ssse3,sse4.1")))

// Returns the first flag or escape from p on, at most kReach bytes on (then p + kReach).
RUBRIC_VECTOR inline Pointer find_near_vector(Pointer p) {
  const __m256i flag = _mm256_set1_epi8(kHdlcFlag);
  const __m256i escape = _mm256_set1_epi8(kHdlcEscape);
  const Pointer stop = p + kReach;
  for (; p != stop; p += 32) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    const __m256i hits = _mm256_or_si256(_mm256_cmpeq_epi8(v, flag), _mm256_cmpeq_epi8(v, escape));
    const auto mask = static_cast<unsigned>(_mm256_movemask_epi8(hits));
    if (mask != 0) return p + _tzcnt_u32(mask);
  }
  return stop;
}

RUBRIC_WIDE inline Pointer find_near_wide(Pointer p) {
  const __m512i flag = _mm512_set1_epi8(kHdlcFlag);
  const __m512i escape = _mm512_set1_epi8(kHdlcEscape);
  const Pointer stop = p + kReach;
  for (; p != stop; p += 64) {
    const __m512i v = _mm512_loadu_si512(p);
    const std::uint64_t hits = _mm512_cmpeq_epi8_mask(v, flag) | _mm512_cmpeq_epi8_mask(v, escape);
    if (hits != 0) return p + _tzcnt_u64(hits);
  }
  return stop;
}

// Returns the first flag from p on, at most up to `stop`.
RUBRIC_VECTOR inline Pointer find_flag_near(Pointer p, Pointer stop) {
  const __m256i flag = _mm256_set1_epi8(kHdlcFlag);
  for (; p < stop; p += 32) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    const auto mask = static_cast<unsigned>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(v, flag)));
    if (mask != 0) return p + _tzcnt_u32(mask);
  }
  return stop;
}

// Undoes the escapes in [begin, end), at most kReach bytes; returns the end of its output, or null
// if an escape is followed by another or by the end: rare enough for slower code.
RUBRIC_WIDE inline std::uint8_t* unescape_wide(Pointer begin, Pointer end, std::uint8_t* out) {
  const __m512i escape = _mm512_set1_epi8(kHdlcEscape);
  const __m512i flip = _mm512_set1_epi8(kHdlcXor);
  std::uint64_t carried = 0;  // The last byte before this chunk was an escape.
  for (Pointer p = begin; p < end; p += 64) {
    const auto left = static_cast<std::uint64_t>(end - p);
    const std::uint64_t valid = _bzhi_u64(~std::uint64_t{0}, left < 64 ? left : 64);
    const __m512i v = _mm512_maskz_loadu_epi8(valid, p);
    const std::uint64_t escapes = _mm512_cmpeq_epi8_mask(v, escape);
    const std::uint64_t escaped = escapes << 1 | carried;
    if ((escapes & escaped) != 0) return nullptr;
    const __m512i plain = _mm512_xor_si512(v, _mm512_maskz_mov_epi8(escaped, flip));
    const std::uint64_t kept = valid & ~escapes;
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi8(kept, plain));
    out += _mm_popcnt_u64(kept);
    carried = escapes >> 63;
  }
  return end[-1] == kHdlcEscape ? nullptr : out;
}

RUBRIC_VECTOR inline std::uint8_t* unescape_near(Pointer begin, Pointer end, std::uint8_t* out) {
  bool dangling = false;
  std::uint8_t* const written = unescape_vector(begin, end, out, &dangling);
  return dangling ? nullptr : written;
}

bool is_usual(std::ptrdiff_t size) {
  return size >= static_cast<std::ptrdiff_t>(kSerialContentMin) &&
         size <= static_cast<std::ptrdiff_t>(kScanContentMax);
}

// Finds frames; the loop is the same for both paths except for the vectors in it.
template <class FindSpecial, class Unescape>
RUBRIC_INLINE Pointer find_frames(Pointer p, Pointer end, ScanBatch& batch,
                                  FindSpecial find_special, Unescape unescape) {
  std::size_t count = 0;
  std::uint8_t* out = batch.unescaped;
  // Close to the end vectors might be loaded from beyond it.
  while (count != kScanBatch && end - p > 2 * kReach) {
    if (*p == kHdlcFlag) {
      ++p;
      continue;
    }
    Pointer close = find_special(p);
    Pointer content = p;
    std::ptrdiff_t size = close - p;
    if (*close == kHdlcEscape) {
      close = find_flag_near(close, p + kReach);
      if (close >= p + kReach) break;
      std::uint8_t* const written = unescape(p, close, out);
      if (written == nullptr) break;
      content = out;
      size = written - out;
      out = written;
    } else if (*close != kHdlcFlag) {
      break;
    }
    if (!is_usual(size)) break;
    batch.frames[count++] = {content, p, static_cast<std::uint32_t>(size), 0};
    p = close + 1;
  }
  batch.count = count;
  return p;
}

// Returns the sum of products over `size` bytes, 1 to 256, of which at least 16 may be read. All
// but the last four blocks are folded by shifts, which are cheaper than multiplications: the square
// of x^256 = x^192 + x^80 + 1 (see crc16_fast.cc) is x^512 = x^384 + x^160 + 1, so a block goes to
// the one after it, to 44 bytes after it and to the one four after it.
RUBRIC_VECTOR inline __m128i multiply_frame(Pointer p, std::size_t size) {
  const __m128i reverse = load128(kReverse);
  const std::size_t head = (size - 1) % 16 + 1;
  // Reversed, the first byte is the highest, so shifts to the right go towards the end.
  __m128i a = _mm_shuffle_epi8(load128(p), load128(kReverse + 16 - head));
  std::size_t behind = (size - 1) / 16;
  p += head;
  const auto next = [&]() RUBRIC_VECTOR {
    const __m128i block = _mm_shuffle_epi8(load128(p), reverse);
    p += 16;
    return block;
  };
  if (behind < 3) {
    __m128i sum = multiply(a, behind);
    while (behind-- != 0) sum = _mm_xor_si128(sum, multiply(next(), behind));
    return sum;
  }
  __m128i b = next();
  __m128i c = next();
  __m128i d = next();
  for (behind -= 3; behind != 0; --behind) {
    const __m128i gone = a;
    a = _mm_xor_si128(b, gone);
    b = _mm_xor_si128(c, _mm_srli_si128(gone, 12));
    c = _mm_xor_si128(d, _mm_slli_si128(gone, 4));
    d = _mm_xor_si128(next(), gone);
  }
  return _mm_xor_si128(_mm_xor_si128(multiply(a, 3), multiply(b, 2)),
                       _mm_xor_si128(multiply(c, 1), multiply(d, 0)));
}

RUBRIC_WIDE inline __m128i multiply_frame_wide(Pointer p, std::size_t size) {
  const __m512i reverse = _mm512_broadcast_i32x4(load128(kReverse));
  const std::size_t head = (size - 1) % 64 + 1;
  std::size_t behind = (size - 1) / 64;
  // Masked bytes are not read at all, so the load may begin in front of the input.
  const __mmask64 mask = ~std::uint64_t{0} << (64 - head);
  const __m512i first = _mm512_maskz_loadu_epi8(mask, p - (64 - head));
  __m512i sum = multiply_wide(_mm512_shuffle_epi8(first, reverse), behind);
  for (p += head; behind-- != 0; p += 64) {
    const __m512i chunk = _mm512_shuffle_epi8(_mm512_loadu_si512(p), reverse);
    sum = _mm512_xor_si512(sum, multiply_wide(chunk, behind));
  }
  return add_lanes(sum);
}

// Flattened, so that the loop above is compiled for the vectors in it.
RUBRIC_VECTOR __attribute__((flatten)) Pointer scan_vector(Pointer begin, Pointer end,
                                                           ScanBatch& batch) {
  const Pointer stop = find_frames(begin, end, batch, find_near_vector, unescape_near);
  __m128i sums[kScanBatch];
  for (std::size_t i = 0; i < batch.count; ++i) {
    const ScannedFrame& frame = batch.frames[i];
    sums[i] = multiply_frame(frame.content, frame.size_bytes - kSerialCrcBytes);
  }
  for (std::size_t i = 0; i < batch.count; ++i) batch.frames[i].crc = reduce(sums[i]);
  return stop;
}

RUBRIC_WIDE inline __m512i constant(std::uint64_t value) {
  return _mm512_set1_epi64(static_cast<long long>(value));
}

// Reduces four sums at a time.
RUBRIC_WIDE inline __m512i reduce_four(__m512i sum) {
  const __m512i value =
      _mm512_xor_si512(sum, _mm512_clmulepi64_epi128(sum, constant(power_of_x(64)), 0x01));
  const __m512i product =
      _mm512_clmulepi64_epi128(_mm512_srli_epi64(value, 16), constant(barrett_quotient()), 0x00);
  const __m512i quotient = _mm512_bsrli_epi128(product, 6);
  return _mm512_xor_si512(value, _mm512_clmulepi64_epi128(quotient, constant(kPolynomial), 0x00));
}

RUBRIC_WIDE __attribute__((flatten)) Pointer scan_wide(Pointer begin, Pointer end,
                                                       ScanBatch& batch) {
  const Pointer stop = find_frames(begin, end, batch, find_near_wide, unescape_wide);
  alignas(64) std::uint64_t sums[kScanBatch][2];
  const std::size_t count = batch.count;
  for (std::size_t i = 0; i < count; ++i) {
    const ScannedFrame& frame = batch.frames[i];
    _mm_store_si128(reinterpret_cast<__m128i*>(sums[i]),
                    multiply_frame_wide(frame.content, frame.size_bytes - kSerialCrcBytes));
  }
  for (std::size_t i = count; i % 4 != 0; ++i) sums[i][0] = sums[i][1] = 0;
  for (std::size_t i = 0; i < count; i += 4) {
    _mm512_store_si512(sums[i], reduce_four(_mm512_load_si512(sums[i])));
  }
  for (std::size_t i = 0; i < count; ++i) {
    batch.frames[i].crc = static_cast<std::uint16_t>(sums[i][0]);
  }
  return stop;
}

}  // namespace

const std::uint8_t* scan_frames(const std::uint8_t* begin, const std::uint8_t* end,
                                ScanBatch& batch, CpuPath path) {
  return path == CpuPath::kWide ? scan_wide(begin, end, batch) : scan_vector(begin, end, batch);
}

#else

const std::uint8_t* scan_frames(const std::uint8_t* begin, const std::uint8_t*, ScanBatch& batch,
                                CpuPath) {
  batch.count = 0;
  return begin;
}

#endif

}  // namespace rubric
