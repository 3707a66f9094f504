#include "codec/containers/crc16_fast.h"

#include <array>
#include <bit>
#include <cstring>

#include "codec/runtime/crc16.h"
#include "codec/runtime/ieee802154_fcs.h"

namespace rubric {
namespace {

constexpr std::size_t kSlices = 16;
using Tables = std::array<std::array<std::uint16_t, 256>, kSlices>;

// tables[k][b]: the effect of byte b after k zero bytes.
template <std::uint16_t (*kStep)(std::uint16_t, std::uint8_t)>
constexpr Tables make_tables() {
  Tables tables{};
  for (std::size_t b = 0; b < 256; ++b) {
    std::uint16_t crc = kStep(0, static_cast<std::uint8_t>(b));
    for (std::size_t k = 0; k < kSlices; ++k) {
      tables[k][b] = crc;
      crc = kStep(crc, 0);
    }
  }
  return tables;
}

alignas(64) constexpr Tables kCrcTables = make_tables<crc16_step>();
alignas(64) constexpr Tables kFcsTables = make_tables<fcs_step>();

// Both sums take the two bytes of the state into the first two bytes of the input: the CRC with
// its high byte first, the reflected FCS with its low byte first.
template <bool kReflected>
std::uint16_t slice_by_8(const std::uint8_t* p, std::size_t left, std::uint16_t crc) {
  constexpr const Tables& tables = kReflected ? kFcsTables : kCrcTables;
  for (; left >= 8; left -= 8, p += 8) {
    const std::size_t high = crc >> 8;
    const std::size_t low = crc & 0xFF;
    // The look-ups that do not wait for the state come first, so that they overlap.
    const int rest = tables[5][p[2]] ^ tables[4][p[3]] ^ tables[3][p[4]] ^ tables[2][p[5]] ^
                     tables[1][p[6]] ^ tables[0][p[7]];
    crc = static_cast<std::uint16_t>(rest ^ tables[7][p[0] ^ (kReflected ? low : high)] ^
                                     tables[6][p[1] ^ (kReflected ? high : low)]);
  }
  for (; left != 0; --left, ++p) {
    const std::size_t out = ((kReflected ? crc : crc >> 8) ^ *p) & 0xFF;
    const int kept = kReflected ? crc >> 8 : crc << 8;
    crc = static_cast<std::uint16_t>(kept ^ tables[0][out]);
  }
  return crc;
}

// Folds without multiplication. The polynomial is sparse, and squaring keeps it so:
//   x^16 = x^12 + x^5 + 1, hence x^256 = x^192 + x^80 + 1 and x^128 = x^96 + x^40 + 1.
// So a word of 64 bits may be added to the word after it (192 = 256 - 64), to the bits 176 after it
// (two words and 48 bits) and to the word four after it, and be gone. All distances are whole
// bytes: words stay in memory order, and the reflected sum differs only in its tables. The same
// holds for words of 32 bits and x^128.
struct Window64 {
  std::uint64_t w[4];

  // Folds w[kAt] away and puts the word four after it in its place.
  template <int kAt>
  RUBRIC_INLINE void step(std::uint64_t next) {
    const std::uint64_t gone = w[kAt];
    w[(kAt + 1) % 4] ^= gone;
    w[(kAt + 2) % 4] ^= gone << 48;
    w[(kAt + 3) % 4] ^= gone >> 16;
    w[kAt] = next ^ gone;
  }
};

RUBRIC_INLINE std::uint64_t load64(const std::uint8_t* p) {
  std::uint64_t word;
  std::memcpy(&word, p, sizeof(word));
  return word;
}

// Folds 32 bytes to 16 and looks those up, each in a table of its own.
template <bool kReflected>
RUBRIC_INLINE std::uint16_t finish_fold(const Window64& window) {
  constexpr const Tables& tables = kReflected ? kFcsTables : kCrcTables;
  std::uint32_t v[8];
  std::memcpy(v, window.w, sizeof(v));
  for (int i = 0; i < 4; ++i) {
    v[i + 1] ^= v[i];
    v[i + 2] ^= v[i] << 24;
    v[i + 3] ^= v[i] >> 8;
    v[i + 4] ^= v[i];
  }
  int crc = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t word = v[4 + i];
    crc ^= tables[15 - 4 * i][word & 0xFF] ^ tables[14 - 4 * i][word >> 8 & 0xFF] ^
           tables[13 - 4 * i][word >> 16 & 0xFF] ^ tables[12 - 4 * i][word >> 24];
  }
  return static_cast<std::uint16_t>(crc);
}

// Below this many bytes, table look-ups alone are as fast.
constexpr std::size_t kFoldMin = 40;

template <bool kReflected>
std::uint16_t fold(const std::uint8_t* p, std::size_t size) {
  // Zeros in front do not change a sum that starts at 0: they fill up the first word.
  const std::size_t head = (size - 1) % 8 + 1;
  std::size_t words = (size + 7) / 8 - 4;
  Window64 window{{load64(p) << (64 - 8 * head), load64(p + head), load64(p + head + 8),
                   load64(p + head + 16)}};
  p += head + 24;
  for (; words % 4 != 0; --words, p += 8) {
    window.step<0>(load64(p));
    window = {{window.w[1], window.w[2], window.w[3], window.w[0]}};
  }
  for (; words != 0; words -= 4, p += 32) {
    window.step<0>(load64(p));
    window.step<1>(load64(p + 8));
    window.step<2>(load64(p + 16));
    window.step<3>(load64(p + 24));
  }
  return finish_fold<kReflected>(window);
}

template <bool kReflected>
std::uint16_t sum_portable(Bytes bytes, std::uint16_t crc) {
  const bool foldable = std::endian::native == std::endian::little && crc == 0;
  if (!foldable || bytes.size() < kFoldMin) {
    return slice_by_8<kReflected>(bytes.data(), bytes.size(), crc);
  }
  return fold<kReflected>(bytes.data(), bytes.size());
}

}  // namespace

std::uint16_t crc16_portable(Bytes bytes, std::uint16_t crc) {
  return sum_portable<false>(bytes, crc);
}
std::uint16_t fcs_portable(Bytes bytes) { return sum_portable<true>(bytes, 0); }

CpuPath best_cpu_path() {
  static const CpuPath path = cpu_has(CpuPath::kWide)     ? CpuPath::kWide
                              : cpu_has(CpuPath::kVector) ? CpuPath::kVector
                                                          : CpuPath::kPortable;
  return path;
}

std::uint16_t crc16_fast(Bytes bytes, std::uint16_t crc, CpuPath path) {
  if (path == CpuPath::kWide) return crc16_wide(bytes, crc);
  if (path == CpuPath::kVector) return crc16_vector(bytes, crc);
  return crc16_portable(bytes, crc);
}
std::uint16_t fcs_fast(Bytes bytes, CpuPath path) {
  return path == CpuPath::kPortable ? fcs_portable(bytes) : fcs_vector(bytes);
}

}  // namespace rubric
