// The content of a serial frame, from the kind byte to the CRC, taken apart and put together.
//
// The rule that both directions keep, also for frames that are too short to hold everything:
// - the first byte is the kind;
// - if at least two bytes follow it, the last two are the CRC; else there is none (kAbsent);
// - if the kind is 0x43 or 0x44 and a byte stands between kind and CRC (or behind the kind where
//   there is no CRC), it is the sequence number;
// - what is left between is `bytes`.
// A frame of which bytes were dropped has lost its end: all that was kept behind kind and sequence
// number is `bytes`, and there is no CRC. So kind, sequence number, bytes and CRC, each where
// present, are in this order exactly what was kept of the content.
#pragma once

#include <cstddef>
#include <string>

#include "codec/containers/cpu.h"
#include "codec/containers/packet.h"

namespace rubric {

/// Fills kind, serial_seq, bytes and crc of `packet` from `content` by the rule above. The
/// packet's dropped_bytes must be set before.
void split_serial_content(Bytes content, Packet& packet);

/// Size of what split_serial_content took apart.
std::size_t serial_content_size(const Packet& packet);

/// The content that split_serial_content took apart, appended to `out`: its exact inverse.
void append_serial_content(const Packet& packet, std::string& out);

/// What is wrong with a whole content: kTooLong, kTooShort, kCrc or nothing. The offset counts
/// from the kind byte.
Error check_serial_content(Bytes content, CpuPath path = best_cpu_path());

/// Everything about the content of one frame that stands alone, as in a capture file.
void decode_serial_content(Bytes content, Packet& packet);

}  // namespace rubric
