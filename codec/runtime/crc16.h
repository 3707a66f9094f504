// CRC-16 of the serial line without a table, for motes. Hosts use codec/containers/crc16_fast.h.
#pragma once

#include "codec/runtime/bytes.h"

namespace rubric {

/// Adds one byte to a CRC-16/XMODEM: polynomial 0x1021, initial value 0, no reflection, no final
/// xor. Source: TEP 113, section 3.1.
///
/// With x the byte that leaves the register, x * 0x1021 falls apart into shifts of x once its high
/// nibble is folded onto the low one: a dozen instructions on an 8-bit processor, no table.
constexpr uint16_t crc16_step(uint16_t crc, uint8_t byte) {
  const uint8_t out = static_cast<uint8_t>((crc >> 8) ^ byte);
  const uint8_t x = static_cast<uint8_t>(out ^ (out >> 4));
  // The cast to 16 bits first keeps int, 16 bits wide on AVR, from overflowing.
  const uint16_t wide = x;
  return static_cast<uint16_t>(static_cast<uint16_t>(crc << 8) ^ static_cast<uint16_t>(wide << 12) ^
                               static_cast<uint16_t>(wide << 5) ^ wide);
}

/// Returns the CRC of `bytes`, continued from `crc`. The check value of "123456789" is 0x31C3.
constexpr uint16_t crc16(Bytes bytes, uint16_t crc = 0) {
  for (size_t i = 0; i < bytes.size(); ++i) crc = crc16_step(crc, bytes[i]);
  return crc;
}

}  // namespace rubric
