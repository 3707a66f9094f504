#include "codec/containers/zep_packet.h"

#include <algorithm>
#include <optional>

#include "codec/containers/link_record.h"
#include "codec/runtime/crc16.h"

namespace rubric {
namespace {

constexpr std::size_t kZepHeaderV1 = 16;
constexpr std::size_t kZepHeaderV2 = 32;
constexpr std::size_t kZepAckBytes = 8;
constexpr std::size_t kChipBytes = 2;      // RSSI; then the CRC's verdict and the correlation.
constexpr std::uint8_t kChipCrcOk = 0x80;  // Bit of the last byte.

constexpr std::int64_t kNtpTo1970Seconds = 2'208'988'800;
constexpr std::int64_t kSecondNs = 1'000'000'000;

Failure zep_fault(Fault fault, std::size_t at) { return fail(fault, at, "WIRE-ZEP"_rule); }

// RFC 5905: seconds since 1900 and their fraction. Values below 1968 are of the era after 2036.
std::int64_t time_of_ntp(const std::uint8_t* at) {
  const std::int64_t low = load_be32(at);
  const std::int64_t fraction = load_be32(at + 4);
  if (low == 0 && fraction == 0) return kNoTime;
  const std::int64_t seconds = low < 0x80000000 ? low + 0x100000000 : low;
  return (seconds - kNtpTo1970Seconds) * kSecondNs + ((fraction * kSecondNs) >> 32);
}

void store_ntp(std::int64_t time_ns, std::uint8_t* at) {
  if (time_ns < 0) return;  // Also kNoTime.
  const std::int64_t rest_ns = time_ns % kSecondNs;
  store_be32(at, static_cast<std::uint32_t>(time_ns / kSecondNs + kNtpTo1970Seconds));
  // Rounded up, so that reading it gives the same nanosecond.
  store_be32(at + 4, static_cast<std::uint32_t>(((rest_ns << 32) + kSecondNs - 1) / kSecondNs));
}

// Reads a datagram that the capture cut: `missing` bytes after it are not there.
void decode_cut_zep_datagram(Bytes datagram, std::uint64_t missing, Packet& packet) {
  const bool v2 = datagram.size() > 2 && datagram[2] == 2;
  const std::size_t header = std::min(datagram.size(), v2 ? kZepHeaderV2 : kZepHeaderV1);
  packet.framing = Framing::kRadio;
  packet.kind = packet.serial_seq = packet.crc = packet.fcs = kAbsent;
  packet.bytes = datagram.from(header);
  packet.offset_bytes += header;
  packet.dropped_bytes = missing;
  packet.error = fail(Fault::kCut, packet.bytes.size(), ReqId::kNone).error;
}

constexpr std::uint16_t kEtherIpv4 = 0x0800;
constexpr std::uint16_t kEtherIpv6 = 0x86DD;
constexpr std::uint16_t kEtherVlan = 0x8100;
constexpr std::uint16_t kEtherServiceVlan = 0x88A8;
constexpr std::uint8_t kProtocolUdp = 17;
constexpr std::size_t kIpv4HeaderMin = 20;
constexpr std::size_t kIpv6HeaderBytes = 40;
constexpr std::size_t kUdpHeaderBytes = 8;

/// Holds the captured rest of a record, and the number of bytes that this rest has when whole.
struct Rest {
  Bytes bytes;
  std::uint64_t size;

  bool drop(std::size_t count) {
    if (bytes.size() < count) return false;
    bytes = bytes.from(count);
    size -= count;
    return true;
  }
  void keep(std::uint64_t count) {
    size = std::min(size, count);
    bytes = bytes.first(std::min<std::uint64_t>(bytes.size(), size));
  }
};

bool take_ethernet(Rest& rest, std::uint16_t& type) {
  if (rest.bytes.size() < 14) return false;
  type = load_be16(rest.bytes.data() + 12);
  rest.drop(14);
  while (type == kEtherVlan || type == kEtherServiceVlan) {
    if (rest.bytes.size() < 4) return false;
    type = load_be16(rest.bytes.data() + 2);
    rest.drop(4);
  }
  return true;
}

bool take_link_header(Rest& rest, std::uint16_t link_type, std::uint16_t& type) {
  switch (link_type) {
    case kLinkEthernet: return take_ethernet(rest, type);
    case kLinkSll:
      if (rest.bytes.size() < 16) return false;
      type = load_be16(rest.bytes.data() + 14);
      return rest.drop(16);
    case kLinkSll2:
      if (rest.bytes.size() < 20) return false;
      type = load_be16(rest.bytes.data());
      return rest.drop(20);
    case kLinkNull:
    case kLinkLoop:
      // Before the packet is its family, whose number each system chooses and the version repeats.
      if (!rest.drop(4)) return false;
      [[fallthrough]];
    default:
      if (rest.bytes.empty()) return false;
      type = rest.bytes[0] >> 4 == 6 ? kEtherIpv6 : kEtherIpv4;
      return true;
  }
}

bool take_ipv4(Rest& rest) {
  if (rest.bytes.size() < kIpv4HeaderMin || rest.bytes[0] >> 4 != 4) return false;
  const std::uint8_t* const ip = rest.bytes.data();
  constexpr std::uint16_t kMoreOrOffset = 0x3FFF;
  if (ip[9] != kProtocolUdp || (load_be16(ip + 6) & kMoreOrOffset) != 0) return false;
  const std::size_t header = std::size_t{ip[0] & 0xFU} * 4;
  const std::size_t total = load_be16(ip + 2);
  if (header < kIpv4HeaderMin || (total != 0 && total < header)) return false;
  if (total != 0) rest.keep(total);  // Ethernet pads; 0 where the network card cuts packets up.
  return rest.drop(header);
}

bool take_ipv6(Rest& rest) {
  if (rest.bytes.size() < kIpv6HeaderBytes || rest.bytes[0] >> 4 != 6) return false;
  std::uint8_t next = rest.bytes[6];
  const std::size_t size = load_be16(rest.bytes.data() + 4);
  rest.drop(kIpv6HeaderBytes);
  if (size != 0) rest.keep(size);
  const auto is_extension = [](std::uint8_t header) {
    return header == 0 || header == 43 || header == 60;  // Hop by hop, routing, destination.
  };
  while (is_extension(next)) {
    if (rest.bytes.size() < 2) return false;
    next = rest.bytes[0];
    if (!rest.drop(8 + std::size_t{rest.bytes[1]} * 8)) return false;
  }
  return next == kProtocolUdp;
}

/// Returns whether a datagram of any port is one of ZEP: whether it is whole and no longer.
bool is_zep(const Rest& datagram) {
  const Result<ZepPacket> zep = parse_zep(datagram.bytes);
  if (!zep || datagram.size != datagram.bytes.size()) return false;
  const auto type = zep->type;
  const std::size_t end =
      type == ZepPacket::Type::kAck ? kZepAckBytes : zep->frame_offset_bytes + zep->frame.size();
  const bool known = type == ZepPacket::Type::kData || type == ZepPacket::Type::kAck ||
                     type == ZepPacket::Type::kHello;
  return known && zep->frame.size() <= kRadioFrameMax && end == datagram.size;
}

/// Returns the content of a datagram of ZEP.
std::optional<Rest> zep_datagram(Rest rest, std::uint16_t link_type) {
  std::uint16_t type = 0;
  if (!take_link_header(rest, link_type, type)) return std::nullopt;
  const bool known =
      (type == kEtherIpv4 && take_ipv4(rest)) || (type == kEtherIpv6 && take_ipv6(rest));
  if (!known || rest.bytes.size() < kUdpHeaderBytes) return std::nullopt;
  const std::uint8_t* const udp = rest.bytes.data();
  const bool port = load_be16(udp) == kZepPort || load_be16(udp + 2) == kZepPort;
  const std::size_t length = load_be16(udp + 4);
  if (length != 0 && length < kUdpHeaderBytes) return std::nullopt;
  if (length != 0) rest.keep(length);
  rest.drop(kUdpHeaderBytes);
  if (!port && !is_zep(rest)) return std::nullopt;
  return rest;
}

/// Takes RIOT's check sum for what it is. Since its radio HAL RIOT's native boards end a frame with
/// the CRC of serial frames (cpu/native/socket_zep: crc16_ccitt_false_update from 0), whose bits
/// are not reflected. They check neither; written as an FCS it would be wrong.
void accept_riot_fcs(Packet& packet) {
  if (packet.error.fault != Fault::kFcs || packet.fcs != crc16(packet.bytes)) return;
  packet.fcs = kAbsent;
  packet.error = Error{Fault::kNone, 0, ReqId::kNone};
}

}  // namespace

Result<ZepPacket> parse_zep(Bytes datagram) {
  //= WIRE-ZEP: A ZEP packet begins with the letters EX and version 1 or 2; its length byte says how
  //= many bytes of a radio frame follow its header.
  const std::size_t size = datagram.size();
  const std::uint8_t* const at = datagram.data();
  for (std::size_t i = 0; i < 2 && i < size; ++i) {
    if (at[i] != static_cast<std::uint8_t>("EX"[i])) return zep_fault(Fault::kUnexpected, i);
  }
  if (size < 4) return zep_fault(Fault::kTruncated, size);
  ZepPacket zep{.version = at[2]};
  if (zep.version != 1 && zep.version != 2) return zep_fault(Fault::kUnexpected, 2);
  const bool v2 = zep.version == 2;
  if (v2) zep.type = static_cast<ZepPacket::Type>(at[3]);
  if (zep.type == ZepPacket::Type::kAck) {
    if (size < kZepAckBytes) return zep_fault(Fault::kTruncated, size);
    zep.sequence = load_be32(at + 4);
    return zep;
  }
  const std::size_t header = v2 ? kZepHeaderV2 : kZepHeaderV1;
  if (size < header) return zep_fault(Fault::kTruncated, size);
  const std::uint8_t* const radio = at + (v2 ? 4 : 3);
  zep.channel = radio[0];
  zep.device = load_be16(radio + 1);
  zep.has_fcs = radio[3] != 0;
  zep.lqi = radio[4];
  if (v2) {
    zep.time_ns = time_of_ntp(at + 9);
    zep.sequence = load_be32(at + 17);
  }
  const std::size_t length = at[header - 1];
  if (size - header < length) return zep_fault(Fault::kTruncated, size);
  zep.frame = datagram.from(header).first(length);
  zep.frame_offset_bytes = header;
  return zep;
}

void append_zep(const ZepPacket& zep, std::string& out) {
  std::uint8_t header[kZepHeaderV2] = {'E', 'X', 2, static_cast<std::uint8_t>(zep.type)};
  const bool is_ack = zep.type == ZepPacket::Type::kAck;
  if (is_ack) {
    store_be32(header + 4, zep.sequence);
  } else {
    header[4] = zep.channel;
    store_be16(header + 5, zep.device);
    header[7] = zep.has_fcs;
    header[8] = zep.lqi;
    store_ntp(zep.time_ns, header + 9);
    store_be32(header + 17, zep.sequence);
    header[31] = static_cast<std::uint8_t>(zep.frame.size());
  }
  out.append(reinterpret_cast<const char*>(header), is_ack ? kZepAckBytes : kZepHeaderV2);
  if (!is_ack) out.append(reinterpret_cast<const char*>(zep.frame.data()), zep.frame.size());
}

bool decode_zep_datagram(Bytes datagram, Packet& packet) {
  packet.framing = Framing::kRadio;
  packet.kind = packet.serial_seq = packet.crc = packet.fcs = kAbsent;
  packet.dropped_bytes = 0;
  packet.time_ns = kNoTime;
  packet.radio = RadioFacts{};
  const Result<ZepPacket> zep = parse_zep(datagram);
  if (!zep) {
    packet.bytes = datagram;
    packet.error = zep.error();
    return true;
  }
  packet.time_ns = zep->time_ns;
  const Bytes frame = zep->frame;
  if (frame.empty() || zep->type == ZepPacket::Type::kHello) {
    packet.link_type = zep->type == ZepPacket::Type::kHello ? kLinkZepHello : kLinkZepAck;
    return false;
  }
  packet.offset_bytes += zep->frame_offset_bytes;
  packet.radio.channel = zep->channel;
  constexpr std::uint8_t kLqiUnknown = 255;
  if (zep->lqi != 0 && zep->lqi != kLqiUnknown) packet.radio.lqi = zep->lqi;
  if (zep->has_fcs || frame.size() < kChipBytes) {
    decode_radio_record(frame, kLinkRadioFcs, packet);
    accept_riot_fcs(packet);
    return true;
  }
  packet.radio.rssi = static_cast<std::int8_t>(frame[frame.size() - 2]);
  packet.radio.lqi = frame[frame.size() - 1] & 0x7F;
  decode_radio_record(frame.first(frame.size() - kChipBytes), kLinkRadioNoFcs, packet);
  if (packet.error.fault == Fault::kNone && (frame[frame.size() - 1] & kChipCrcOk) == 0) {
    packet.error = fail(Fault::kFcs, packet.bytes.size(), "WIRE-RADIO-FCS"_rule).error;
  }
  return true;
}

bool is_network_link(std::uint16_t link_type) {
  switch (link_type) {
    case kLinkNull:
    case kLinkEthernet:
    case kLinkRawIp:
    case kLinkRawBsd:
    case kLinkRawOpenBsd:
    case kLinkLoop:
    case kLinkSll:
    case kLinkIpv4:
    case kLinkIpv6:
    case kLinkSll2: return true;
    default: return false;
  }
}

bool is_zep_alone(std::uint16_t link_type) {
  return link_type == kLinkZepAck || link_type == kLinkZepHello;
}

bool decode_udp_record(Bytes record, std::uint64_t original_bytes, std::uint16_t link_type,
                       Packet& packet) {
  const std::optional<Rest> datagram = zep_datagram({record, original_bytes}, link_type);
  if (!datagram) return false;
  const std::int64_t time_ns = packet.time_ns;
  const std::uint64_t begin = packet.offset_bytes;
  const auto before = static_cast<std::size_t>(datagram->bytes.data() - record.data());
  packet.offset_bytes += before;
  const std::uint64_t missing = datagram->size - datagram->bytes.size();
  bool frame = true;
  if (missing == 0) {
    frame = decode_zep_datagram(datagram->bytes, packet);
  } else {
    decode_cut_zep_datagram(datagram->bytes, missing, packet);
  }
  packet.time_ns = time_ns;
  if (frame) packet.link_type = packet.error.requirement == "WIRE-ZEP"_rule ? 0 : kLinkRadioTap;
  if (!frame) packet.offset_bytes = begin;
  return frame;
}

}  // namespace rubric
