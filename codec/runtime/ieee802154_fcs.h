// The check sum of an 802.15.4 frame without a table, for motes.
#pragma once

#include "codec/runtime/bytes.h"

namespace rubric {

/// Adds one byte to the FCS: the CRC-16 of ITU-T with reflected bits, initial value 0. Source: IEEE
/// 802.15.4-2006, section 7.2.1.9.
constexpr uint16_t fcs_step(uint16_t fcs, uint8_t byte) {
  const uint8_t out = static_cast<uint8_t>(fcs ^ byte);
  const uint8_t x = static_cast<uint8_t>(out ^ static_cast<uint8_t>(out << 4));
  const uint16_t wide = x;
  return static_cast<uint16_t>((fcs >> 8) ^ static_cast<uint16_t>(wide << 8) ^
                               static_cast<uint16_t>(wide << 3) ^ (wide >> 4));
}

/// Returns the FCS of `bytes`, continued from `start`; sent low byte first. The check value of
/// "123456789" is 0x2189.
constexpr uint16_t fcs(Bytes bytes, uint16_t start = 0) {
  uint16_t sum = start;
  for (size_t i = 0; i < bytes.size(); ++i) sum = fcs_step(sum, bytes[i]);
  return sum;
}

}  // namespace rubric
