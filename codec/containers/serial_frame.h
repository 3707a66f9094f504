// Splits and joins the content of a serial frame, from the kind byte to the CRC.
//
// Both directions keep this rule, even for frames that are too short to hold everything:
// - the first byte is the kind;
// - if at least two bytes follow it, the last two are the CRC; else there is none (kAbsent);
// - if the kind is 0x43 or 0x44 and a byte lies between kind and CRC (or after the kind where there
//   is no CRC), it is the sequence number;
// - the rest between them is `bytes`.
// A frame with dropped bytes has lost its end: all that was kept after kind and sequence number is
// `bytes`, and there is no CRC. So kind, sequence number, bytes and CRC, each where present, are in
// this order exactly the kept part of the content.
#pragma once

#include <cstddef>
#include <string>

#include "codec/containers/cpu.h"
#include "codec/containers/packet.h"

namespace rubric {

/// Fills kind, serial_seq, bytes and crc of `packet` from `content` by the rule above. The
/// packet's dropped_bytes must be set before.
void split_serial_content(Bytes content, Packet& packet);

/// Appends the content that split_serial_content split to `out`: its exact inverse.
void append_serial_content(const Packet& packet, std::string& out);

/// Returns the fault of a whole content: kTooLong, kTooShort, kCrc or none. The offset counts from
/// the kind byte.
Error check_serial_content(Bytes content, CpuPath path = best_cpu_path());

/// Decodes the content of a single frame, as in a capture file.
void decode_serial_content(Bytes content, Packet& packet);

}  // namespace rubric
