// Reads a record of a capture file by its link type.
#pragma once

#include <cstdint>
#include <string>

#include "codec/containers/packet.h"

namespace rubric {

// LINKTYPE_ values, with this kit's use of USER0 and USER1.
inline constexpr std::uint16_t kLinkSerial = 147;    ///< Serial frame, kind byte to CRC, unescaped.
inline constexpr std::uint16_t kLinkSf = 148;        ///< Serial forwarder packet, no length byte.
inline constexpr std::uint16_t kLinkRadioFcs = 195;  ///< IEEE802_15_4_WITHFCS.
inline constexpr std::uint16_t kLinkRadioNoFcs = 230;  ///< IEEE802_15_4_NOFCS.
inline constexpr std::uint16_t kLinkRadioTap = 283;    ///< IEEE802_15_4_TAP.
inline constexpr std::uint16_t kLinkRadioLinux = 191;  ///< IEEE802_15_4_LINUX.
inline constexpr std::uint16_t kLinkRadioPhy = 215;    ///< IEEE802_15_4_NONASK_PHY.
inline constexpr std::uint16_t kLinkPpi = 192;         ///< A header, then a record of another type.
// Of networks that carry ZEP packets.
inline constexpr std::uint16_t kLinkNull = 0;  ///< A loopback of BSD; a packet has kLinkLoop.
inline constexpr std::uint16_t kLinkEthernet = 1;
inline constexpr std::uint16_t kLinkRawIp = 101;
inline constexpr std::uint16_t kLinkRawBsd = 12;      ///< The same, by its number in older files,
inline constexpr std::uint16_t kLinkRawOpenBsd = 14;  ///< and in those of OpenBSD.
inline constexpr std::uint16_t kLinkLoop = 108;
inline constexpr std::uint16_t kLinkSll = 113;  ///< LINUX_SLL.
inline constexpr std::uint16_t kLinkIpv4 = 228;
inline constexpr std::uint16_t kLinkIpv6 = 229;
inline constexpr std::uint16_t kLinkSll2 = 276;  ///< LINUX_SLL2.
// None of pcap's: ZEP packets without a radio frame.
inline constexpr std::uint16_t kLinkZepAck = 0xFFFE;
inline constexpr std::uint16_t kLinkZepHello = 0xFFFF;

/// The first and the last of the link types that everybody gives a meaning of their own, USER0 to
/// USER15.
inline constexpr std::uint16_t kLinkUserFirst = 147;
inline constexpr std::uint16_t kLinkUserLast = 162;

inline constexpr std::size_t kRadioFrameMax = 127;  ///< FCS included.

/// Reads the radio frame in `record`, which is whole: fills framing, bytes, fcs, error, and moves
/// offset_bytes from the record's first byte to the frame control field. Faults: kEmpty, kTooShort
/// (no room for the FCS), kTooLong, kFcs; for a TAP header kTruncated, kUnexpected (version, FCS
/// type), kOutOfRange (length), with offsets from the record's first byte. An FCS of 32 bits, which
/// only a TAP header announces, is checked and left out: `fcs` is kAbsent, also with kFcs. Does not
/// guess what some sniffers put in place of the FCS. Source: IEEE 802.15.4-2006, sections 6.4.1 and
/// 7.2.1; IEEE 802.15.4-2015, section 7.2.11; LINKTYPE_IEEE802_15_4_TAP.
void decode_radio_record(Bytes record, std::uint16_t link_type, Packet& packet);

/// Returns whether a frame ends with the FCS of the bytes before.
bool ends_with_fcs(Bytes frame);

/// Appends a TAP header with the packet's facts before a frame that has an FCS or none.
void append_tap_header(const RadioFacts& facts, bool has_fcs, std::string& out);

/// Reads a record of any link type; `record` is the captured part and `original_bytes` the original
/// size. `packet` comes with offset_bytes of the record's first byte. Of link type 191 nothing says
/// whether frames have their FCS: one that fits is it. Of a network's packet the ZEP packet in it
/// is read. Faults: those of the link type, kCut (not captured whole, which breaks no rule),
/// kUnexpected and kTruncated by rule `container` (215: the preamble is not as it must be; 192: the
/// header is not),
/// kUnsupported (another link type, or a network's packet without ZEP: kBare and the bytes as they
/// are; a ZEP packet without a frame has the link type kLinkZepAck or kLinkZepHello).
void decode_record(Bytes record, std::uint64_t original_bytes, std::uint16_t link_type,
                   ReqId container, Packet& packet);

}  // namespace rubric
