#include "codec/containers/link_record.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/sf_reader.h"
#include "codec/containers/zep_packet.h"

namespace rubric {
namespace {

constexpr std::size_t kFcsBytes = 2;
constexpr std::size_t kFcs32Bytes = 4;
constexpr Error kSound{Fault::kNone, 0, ReqId::kNone};

enum class FcsType : std::uint8_t { kNone, kCrc16, kCrc32 };

constexpr std::size_t kTapHeaderBytes = 4;
constexpr std::uint16_t kTapFcsType = 0;
constexpr std::uint16_t kTapRss = 1;
constexpr std::uint16_t kTapChannel = 3;
constexpr std::uint16_t kTapSlot = 7;
constexpr std::uint16_t kTapLqi = 10;

Error tap_error(Fault fault, std::size_t at) {
  return fail(fault, at, "WIRE-RADIO-TAP"_rule).error;
}

// Reads a fact of a TAP header; one that is shorter than it must be, or no number, is left out.
void read_tap_fact(std::size_t type, Bytes value, RadioFacts& facts) {
  const std::uint8_t* const at = value.data();
  if (type == kTapRss && value.size() >= 4) {
    const auto rssi = std::bit_cast<float>(load_le32(at));
    if (std::isfinite(rssi)) facts.rssi = rssi;
  } else if (type == kTapChannel && value.size() >= 2) {
    facts.channel = load_le16(at);
    facts.page = value.size() >= 3 ? at[2] : 0;
  } else if (type == kTapSlot && value.size() >= 8 && at[7] < 0x80) {
    facts.slot = static_cast<std::int64_t>(std::uint64_t{load_le32(at + 4)} << 32 | load_le32(at));
  } else if (type == kTapLqi && !value.empty()) {
    facts.lqi = at[0];
  } else if (type != kTapFcsType) {
    facts.more = true;
  }
}

// Reads a TAP header: its size, its FCS type and its facts. An absent FCS type means no FCS.
Error read_tap(Bytes record, std::size_t* size, FcsType* fcs_type, RadioFacts& facts) {
  *fcs_type = FcsType::kNone;
  if (record.size() < kTapHeaderBytes) return tap_error(Fault::kTruncated, record.size());
  if (record[0] != 0) return tap_error(Fault::kUnexpected, 0);
  *size = load_le16(record.data() + 2);
  if (*size < kTapHeaderBytes || *size > record.size()) return tap_error(Fault::kOutOfRange, 2);
  for (std::size_t at = kTapHeaderBytes; at < *size;) {
    if (*size - at < 4) return tap_error(Fault::kTruncated, at);
    const std::size_t type = load_le16(record.data() + at);
    const std::size_t value_size = load_le16(record.data() + at + 2);
    if (*size - at - 4 < value_size) return tap_error(Fault::kTruncated, at);
    if (type == kTapFcsType) {
      if (value_size == 0) return tap_error(Fault::kTruncated, at);
      const std::uint8_t value = record[at + 4];
      if (value > 2) return tap_error(Fault::kUnexpected, at + 4);
      *fcs_type = static_cast<FcsType>(value);
      facts.more = facts.more || *fcs_type == FcsType::kCrc32;
    }
    read_tap_fact(type, record.sub(at + 4, value_size), facts);
    // Values are padded to four bytes; some writers leave the last one's padding out.
    at = std::min(*size, at + 4 + (value_size + 3) / 4 * 4);
  }
  return kSound;
}

// The CRC-32 of Ethernet, bit by bit: few frames have it.
std::uint32_t crc32(Bytes bytes, std::size_t padding) {
  std::uint32_t crc = UINT32_MAX;
  for (std::size_t i = 0; i < bytes.size() + padding; ++i) {
    crc ^= i < bytes.size() ? bytes[i] : 0U;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320 : 0);
  }
  return ~crc;
}

// Splits a frame with an FCS of 32 bits, which a packet has no room for: it is checked and taken
// off. One that is too long stays whole, so that it is too long without an FCS, too.
Error split_wide_frame(Bytes frame, Packet& packet) {
  packet.bytes = frame.size() == kFcs32Bytes ? frame.first(0) : frame;
  if (packet.bytes.empty()) return fail(Fault::kEmpty, 0, "WIRE-RADIO-HEADER"_rule).error;
  constexpr std::size_t kMost = kRadioFrameMax - kFcsBytes;
  if (frame.size() > kRadioFrameMax) {
    return fail(Fault::kTooLong, kMost, "WIRE-RADIO-LENGTH"_rule).error;
  }
  const Error wrong = fail(Fault::kFcs, frame.size(), "WIRE-RADIO-FCS"_rule).error;
  if (frame.size() < kFcs32Bytes) return wrong;
  packet.bytes = frame.first(frame.size() - kFcs32Bytes);
  const std::uint32_t fcs = load_le32(packet.bytes.end());
  // The standard sums fewer than four bytes with zeros behind; Wireshark and others do not.
  const std::size_t size = packet.bytes.size();
  const std::size_t padding = size < kFcs32Bytes ? kFcs32Bytes - size : 0;
  if (fcs == crc32(packet.bytes, 0) || fcs == crc32(packet.bytes, padding)) return kSound;
  return fail(Fault::kFcs, size, "WIRE-RADIO-FCS"_rule).error;
}

Error split_radio_frame(Bytes frame, bool has_fcs, Packet& packet) {
  packet.bytes = frame;
  if (frame.empty()) return fail(Fault::kEmpty, 0, "WIRE-RADIO-HEADER"_rule).error;
  if (has_fcs) {
    if (frame.size() < kFcsBytes) {
      return fail(Fault::kTooShort, frame.size(), "WIRE-RADIO-FCS"_rule).error;
    }
    packet.bytes = frame.first(frame.size() - kFcsBytes);
    packet.fcs = load_le16(packet.bytes.end());
  }
  const std::size_t max = has_fcs ? kRadioFrameMax : kRadioFrameMax - kFcsBytes;
  if (frame.size() > max) return fail(Fault::kTooLong, max, "WIRE-RADIO-LENGTH"_rule).error;
  if (has_fcs && fcs_fast(packet.bytes) != packet.fcs) {
    return fail(Fault::kFcs, packet.bytes.size(), "WIRE-RADIO-FCS"_rule).error;
  }
  return kSound;
}

void decode_radio(Bytes record, std::uint16_t link_type, bool cut, Packet& packet) {
  packet.framing = Framing::kRadio;
  packet.fcs = kAbsent;
  bool has_fcs = link_type == kLinkRadioFcs;
  if (link_type == kLinkRadioTap) {
    std::size_t header = 0;
    FcsType fcs_type = FcsType::kNone;
    packet.bytes = record;
    packet.radio = RadioFacts{};
    packet.error = read_tap(record, &header, &fcs_type, packet.radio);
    if (packet.error.fault != Fault::kNone) {
      packet.radio = RadioFacts{};
      if (cut) packet.framing = Framing::kBare;  // No frame is to be had of it.
      return;
    }
    packet.offset_bytes += header;
    record = record.from(header);
    has_fcs = fcs_type == FcsType::kCrc16;
    if (fcs_type == FcsType::kCrc32 && !cut) {
      packet.error = split_wide_frame(record, packet);
      return;
    }
  }
  // Without its end a frame has no FCS, whatever the capture promises.
  packet.error = split_radio_frame(record, has_fcs && !cut, packet);
}

// Takes off the preamble, the start of frame and the length byte of a frame as the radio sends it.
bool take_phy_header(Bytes& record, bool cut, ReqId container, Packet& packet) {
  constexpr std::size_t kPreambleBytes = 4;
  constexpr std::size_t kHeaderBytes = kPreambleBytes + 2;
  constexpr std::uint8_t kStartOfFrame = 0xA7;
  packet.framing = Framing::kRadio;
  for (std::size_t i = 0; i <= kPreambleBytes && i < record.size(); ++i) {
    if (record[i] == (i < kPreambleBytes ? 0 : kStartOfFrame)) continue;
    packet.error = fail(Fault::kUnexpected, i, container).error;
    return false;
  }
  const bool has_length = record.size() >= kHeaderBytes;
  const std::size_t size = has_length ? record[kHeaderBytes - 1] & 0x7F : 0;
  if (!has_length || (!cut && record.size() - kHeaderBytes < size)) {
    packet.error =
        fail(cut ? Fault::kCut : Fault::kTruncated, record.size(), cut ? ReqId::kNone : container)
            .error;
    return false;
  }
  packet.offset_bytes += kHeaderBytes;
  record = record.from(kHeaderBytes);
  record = record.first(std::min(record.size(), size));
  return true;
}

void put_tap_fact(std::uint16_t type, std::uint64_t value, std::size_t size, std::string& out) {
  std::uint8_t fact[12] = {};
  store_le16(fact, type);
  store_le16(fact + 2, static_cast<std::uint16_t>(size));
  for (std::size_t i = 0; i < size; ++i) fact[4 + i] = static_cast<std::uint8_t>(value >> 8 * i);
  out.append(reinterpret_cast<const char*>(fact), 4 + (size + 3) / 4 * 4);
}

// Reads the record that a PPI header precedes. What the header's fields state is not kept.
void decode_ppi(Bytes record, std::uint64_t original_bytes, ReqId container, Packet& packet) {
  constexpr std::size_t kHeaderBytes = 8;
  packet.framing = Framing::kRadio;
  const bool has_sizes = record.size() >= kHeaderBytes;
  const std::size_t header = has_sizes ? load_le16(record.data() + 2) : kHeaderBytes;
  if (record.size() < header) {
    const bool cut = original_bytes > record.size();
    packet.error =
        fail(cut ? Fault::kCut : Fault::kTruncated, record.size(), cut ? ReqId::kNone : container)
            .error;
    return;
  }
  const std::uint32_t inner = load_le32(record.data() + 4);
  if (header < kHeaderBytes || inner > UINT16_MAX || inner == kLinkPpi) {
    packet.error = fail(Fault::kUnexpected, header < kHeaderBytes ? 2 : 4, container).error;
    return;
  }
  packet.offset_bytes += header;
  // A broken capture may state fewer bytes than the header has.
  const std::uint64_t rest = original_bytes - std::min<std::uint64_t>(original_bytes, header);
  decode_record(record.from(header), rest, static_cast<std::uint16_t>(inner), container, packet);
  packet.radio.more = packet.radio.more || header > kHeaderBytes;
}

}  // namespace

bool ends_with_fcs(Bytes record) {
  if (record.size() <= kFcsBytes) return false;
  const Bytes frame = record.first(record.size() - kFcsBytes);
  return fcs_fast(frame) == load_le16(frame.end());
}

void append_tap_header(const RadioFacts& facts, bool has_fcs, std::string& out) {
  const std::size_t begin = out.size();
  out.append(kTapHeaderBytes, '\0');
  put_tap_fact(kTapFcsType, static_cast<std::uint64_t>(has_fcs), 1, out);
  if (facts.rssi) put_tap_fact(kTapRss, std::bit_cast<std::uint32_t>(*facts.rssi), 4, out);
  if (facts.channel != kAbsent) {
    const auto channel = static_cast<std::uint64_t>(facts.channel & 0xFFFF);
    put_tap_fact(kTapChannel, std::uint64_t{facts.page} << 16 | channel, 3, out);
  }
  if (facts.slot != kAbsent) put_tap_fact(kTapSlot, static_cast<std::uint64_t>(facts.slot), 8, out);
  if (facts.lqi != kAbsent) put_tap_fact(kTapLqi, static_cast<std::uint64_t>(facts.lqi), 1, out);
  out[begin + 2] = static_cast<char>(out.size() - begin);
}

void decode_radio_record(Bytes record, std::uint16_t link_type, Packet& packet) {
  decode_radio(record, link_type, false, packet);
}

void decode_record(Bytes record, std::uint64_t original_bytes, std::uint16_t link_type,
                   ReqId container, Packet& packet) {
  const bool cut = original_bytes > record.size();
  if (is_network_link(link_type)) {
    if (decode_udp_record(record, original_bytes, link_type, packet)) return;
    if (is_zep_alone(packet.link_type)) link_type = packet.link_type;
  }
  packet.link_type = link_type == kLinkNull ? kLinkLoop : link_type;
  packet.kind = packet.serial_seq = packet.crc = packet.fcs = kAbsent;
  packet.dropped_bytes = cut ? original_bytes - record.size() : 0;
  packet.bytes = record;
  packet.error = kSound;
  switch (link_type) {
    case kLinkSerial: decode_serial_content(record, packet); break;
    case kLinkSf:
      packet.framing = Framing::kSf;
      if (record.empty()) packet.error = fail(Fault::kEmpty, 0, "WIRE-SF-LENGTH"_rule).error;
      if (record.size() > kSfPacketMax) {
        packet.error = fail(Fault::kTooLong, kSfPacketMax, "WIRE-SF-LENGTH"_rule).error;
      }
      break;
    case kLinkRadioPhy:
      if (!take_phy_header(record, cut, container, packet)) return;
      packet.link_type = kLinkRadioFcs;
      decode_radio(record, kLinkRadioFcs, cut, packet);
      break;
    case kLinkRadioLinux:
      packet.link_type = !cut && ends_with_fcs(record) ? kLinkRadioFcs : kLinkRadioNoFcs;
      decode_radio(record, packet.link_type, cut, packet);
      break;
    case kLinkRadioFcs:
    case kLinkRadioNoFcs:
    case kLinkRadioTap: decode_radio(record, link_type, cut, packet); break;
    case kLinkPpi: return decode_ppi(record, original_bytes, container, packet);
    default:
      packet.framing = Framing::kBare;
      packet.error = fail(Fault::kUnsupported, 0, container).error;
      return;
  }
  // A serial frame's error counts from the kind byte, which precedes `bytes`.
  const std::size_t end = link_type == kLinkSerial ? record.size() : packet.bytes.size();
  if (cut) packet.error = fail(Fault::kCut, end, ReqId::kNone).error;
}

}  // namespace rubric
