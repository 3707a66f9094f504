// Sums of frames by their definitions, bit by bit.
#pragma once

#include <cstdint>

#include "codec/runtime/bytes.h"

namespace rubric::fuzz {

/// Divides by the polynomial of CRC-16, the highest bit first.
inline std::uint16_t crc_by_definition(Bytes bytes, unsigned crc = 0) {
  for (const std::uint8_t byte : bytes) {
    crc ^= unsigned{byte} << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000) != 0 ? crc << 1 ^ 0x1021 : crc << 1;
    crc &= 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

/// IEEE 802.15.4-2006, section 7.2.1.9: bits in the order of sending, the least significant first.
inline std::uint16_t fcs_by_definition(Bytes bytes) {
  unsigned fcs = 0;
  for (const std::uint8_t byte : bytes) {
    fcs ^= byte;
    for (int bit = 0; bit < 8; ++bit) fcs = (fcs & 1) != 0 ? fcs >> 1 ^ 0x8408 : fcs >> 1;
  }
  return static_cast<std::uint16_t>(fcs);
}

/// The sum of Ethernet, bits in the same order.
inline std::uint32_t crc32_by_definition(Bytes bytes) {
  std::uint32_t sum = UINT32_MAX;
  for (const std::uint8_t byte : bytes) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? sum >> 1 ^ 0xEDB88320 : sum >> 1;
  }
  return ~sum;
}

}  // namespace rubric::fuzz
