// Frames for the tests of the formatters.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/encode.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "tools/format/record.h"

namespace rubric::format {

inline const reflect::Protocol& rubicon() { return *reflect::find_protocol("rubicon"); }

/// Returns the bytes of hex digits; skips blanks.
inline std::vector<std::uint8_t> from_hex(std::string_view hex) {
  std::vector<std::uint8_t> bytes;
  reflect::parse_hex(hex, bytes);
  return bytes;
}

/// A packet of given bytes, decoded.
struct Sample {
  explicit Sample(std::string_view hex, Framing framing = Framing::kSf, std::string_view bare = {})
      : Sample(from_hex(hex), framing, bare) {}
  Sample(std::vector<std::uint8_t> content, Framing framing, std::string_view bare = {})
      : bytes(std::move(content)),
        decoder(rubicon(), bare.empty() ? nullptr : reflect::find_type(rubicon(), bare)) {
    packet.framing = framing;
    packet.bytes = Bytes(bytes.data(), bytes.size());
    if (framing == Framing::kHdlc) {
      packet.kind = 69;
      packet.crc = 0x1234;
    }
    record.frame = &frame;
    decode();
  }
  Sample(const Sample&) = delete;
  Sample& operator=(const Sample&) = delete;

  /// Decodes again, after a change of `packet`.
  void decode() { decoder.decode(packet, frame); }

  std::string print(Formatter& formatter) const {
    Buffer out(64);
    formatter.print(record, out);
    return std::string(out.view());
  }

  std::vector<std::uint8_t> bytes;
  Packet packet;
  reflect::FrameDecoder decoder;
  reflect::Frame frame;
  Record record;
};

/// Three readings of mote 2, forwarded by a sink: two stale bytes.
inline constexpr std::string_view kUpdates =
    "00 ffff 0000 1e 00 1c 000b fffd 000b 0002 00 b0d3 12 03 0a 23 03 0001 012e 0002 1902 "
    "0040 04b2 beef";
/// A mote asks to join.
inline constexpr std::string_view kJoinRequest = "c4f5 01 2043 01";

}  // namespace rubric::format
