// The innermost loop of the deframer: finds, unescapes and sums many frames at a time, with finding
// and summing each in a loop of its own, so that neither waits for the other's results.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codec/containers/cpu.h"

namespace rubric {

/// A frame between two flags.
struct ScannedFrame {
  const std::uint8_t* content;  ///< The kind byte; in place or, if there were escapes, in a batch.
  const std::uint8_t* wire;     ///< Its place in the input.
  std::uint32_t size_bytes;     ///< Kind to CRC: kSerialContentMin to kScanContentMax.
  std::uint16_t crc;            ///< Over all but the last two bytes; not compared.
};

inline constexpr std::size_t kScanBatch = 32;
/// Longer frames are left to other code. All of up to this size may be sound.
inline constexpr std::size_t kScanContentMax = 255;
/// How far from its first byte the scan looks for a frame's end.
inline constexpr std::size_t kScanReach = 320;

/// The results of one scan; big, so keep and reuse it.
struct ScanBatch {
  std::size_t count;
  ScannedFrame frames[kScanBatch];
  std::uint8_t unescaped[kScanBatch * kScanReach + 64];
};

/// Fills `batch` with the frames at the front of [begin, end) and returns where it stopped, after a
/// flag. It stops when the batch is full or at the first frame of an unusual size, that is aborted,
/// or that has no end within reach; slower code handles that one. `path` is not kPortable, and
/// cpu_has() it.
const std::uint8_t* scan_frames(const std::uint8_t* begin, const std::uint8_t* end,
                                ScanBatch& batch, CpuPath path);

}  // namespace rubric
