// A packet of the ZigBee Encapsulation Protocol (ZEP): a radio frame in a UDP datagram, and the
// datagram in a record of a network.
#pragma once

#include <cstdint>
#include <string>

#include "codec/containers/packet.h"

namespace rubric {

inline constexpr std::uint16_t kZepPort = 17754;

struct ZepPacket {
  enum class Type : std::uint8_t { kData = 1, kAck = 2, kHello = 255 };
  std::uint8_t version = 2;
  Type type = Type::kData;  ///< Others carry a frame, too, but for a hello of RIOT: an address.
  std::uint8_t channel = 26;
  std::uint16_t device = 0;
  /// The frame ends with its FCS; else its last two bytes are what a CC24xx chip puts there.
  bool has_fcs = true;
  std::uint8_t lqi = 255;
  std::int64_t time_ns = kNoTime;  ///< Since 1970; version 2 only.
  std::uint32_t sequence = 0;      ///< Version 2 only.
  Bytes frame;                     ///< With those two bytes.
  std::size_t frame_offset_bytes = 0;
};

/// Parses a datagram of version 1 or 2. Ignores bytes after the frame, as Wireshark does. Faults by
/// WIRE-ZEP: kTruncated, kUnexpected (preamble, version). Source: Wireshark, packet-zep.c.
Result<ZepPacket> parse_zep(Bytes datagram);

/// Appends a packet of version 2; a time before 1970 is left out.
void append_zep(const ZepPacket& zep, std::string& out);

/// Reads the radio frame in a datagram into `packet`; offset_bytes moves from the datagram's first
/// byte to the frame control field; time_ns is the sender's. Returns false for a sound packet
/// without frame, an ack or a hello. A malformed datagram is a radio frame with an error and the
/// bytes as they are.
bool decode_zep_datagram(Bytes datagram, Packet& packet);

/// Returns whether records of this link type are packets of a network: Ethernet, IP of either
/// version, BSD's loopback, and what Linux captures on its pseudo-interface "any".
bool is_network_link(std::uint16_t link_type);

/// Returns whether a packet of this link type is a ZEP packet without a radio frame.
bool is_zep_alone(std::uint16_t link_type);

/// Reads the radio frame in a UDP datagram from or to ZEP's port, or in a sound ZEP packet on
/// another one. `record` is the captured part of `original_bytes`; `packet` comes with offset_bytes
/// of the record's first byte, and keeps the capture's time. It leaves with the link type TAP, as
/// ZEP states facts of the same kind. Returns false where there is no frame: another protocol, a
/// fragment, or a ZEP packet alone, as link_type says then.
/// Faults: those of decode_zep_datagram(), kCut. Sources: RFC 791, RFC 8200, RFC 768;
/// LINKTYPE_ETHERNET, _LINUX_SLL, _LINUX_SLL2, _NULL, _LOOP, _RAW.
bool decode_udp_record(Bytes record, std::uint64_t original_bytes, std::uint16_t link_type,
                       Packet& packet);

}  // namespace rubric
