// Scripts as bytes. Every byte string is a script, so that a fuzzer may change any byte:
//
//   head   role and profile u8, id u16, island u16, channels u8, first number u16, rest u16
//   steps  kind u8, delay u16, what the kind needs
//
// all big-endian. A number out of range is mapped into the range, and missing bytes at the end are
// zeros.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/runtime/bytes.h"
#include "conformance/selftest/scripts/script.h"

namespace rubric::script {

constexpr std::size_t kHeadBytes = 10;

/// Decodes any bytes.
Script decode(Bytes bytes);
/// Encodes a script: decode(encode(s)) is s, for every script that decode() makes.
std::vector<std::uint8_t> encode(const Script& script);

/// Returns where each step begins in the bytes that encode() makes, and after the last their end.
std::vector<std::size_t> step_offsets(const Script& script);

/// Longer delays, beyond 0x8000 ticks, add whole multiples of kLongTicks.
constexpr Ticks kShortDelayMax = 0x8000;
constexpr Ticks kLongTicks = 4;
/// Returns the nearest delay that can be encoded.
Ticks fitting_delay(Ticks delay);

}  // namespace rubric::script
