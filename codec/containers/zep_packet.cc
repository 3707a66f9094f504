#include "codec/containers/zep_packet.h"

#include "codec/containers/link_record.h"

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
  ZepPacket zep;
  zep.version = at[2];
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
  const Result<ZepPacket> zep = parse_zep(datagram);
  if (!zep) {
    packet.bytes = datagram;
    packet.error = zep.error();
    return true;
  }
  packet.time_ns = zep->time_ns;
  const Bytes frame = zep->frame;
  if (frame.empty()) return false;
  packet.offset_bytes += zep->frame_offset_bytes;
  if (zep->has_fcs || frame.size() < kChipBytes) {
    decode_radio_record(frame, kLinkRadioFcs, packet);
    return true;
  }
  decode_radio_record(frame.first(frame.size() - kChipBytes), kLinkRadioNoFcs, packet);
  if (packet.error.fault == Fault::kNone && (frame[frame.size() - 1] & kChipCrcOk) == 0) {
    packet.error = fail(Fault::kFcs, packet.bytes.size(), "WIRE-RADIO-FCS"_rule).error;
  }
  return true;
}

}  // namespace rubric
