#include "codec/containers/link_record.h"

#include <algorithm>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/sf_reader.h"

namespace rubric {
namespace {

constexpr std::size_t kFcsBytes = 2;
constexpr Error kSound{Fault::kNone, 0, ReqId::kNone};

enum class FcsType : std::uint8_t { kNone, kCrc16, kCrc32 };

constexpr std::size_t kTapHeaderBytes = 4;
constexpr std::uint16_t kTapFcsType = 0;

Error tap_error(Fault fault, std::size_t at) {
  return fail(fault, at, "WIRE-RADIO-TAP"_rule).error;
}

// Reads a TAP header: its size and its FCS type. An absent FCS type means no FCS.
Error read_tap(Bytes record, std::size_t* size, FcsType* fcs_type) {
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
      if (value == 2) return tap_error(Fault::kUnsupported, at + 4);
      *fcs_type = static_cast<FcsType>(value);
    }
    // Values are padded to four bytes; some writers leave the last one's padding out.
    at = std::min(*size, at + 4 + (value_size + 3) / 4 * 4);
  }
  return kSound;
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
    packet.error = read_tap(record, &header, &fcs_type);
    if (packet.error.fault != Fault::kNone) return;
    packet.offset_bytes += header;
    record = record.from(header);
    has_fcs = fcs_type == FcsType::kCrc16;
  }
  // Without its end a frame has no FCS, whatever the capture promises.
  packet.error = split_radio_frame(record, has_fcs && !cut, packet);
}

}  // namespace

void decode_radio_record(Bytes record, std::uint16_t link_type, Packet& packet) {
  decode_radio(record, link_type, false, packet);
}

void decode_record(Bytes record, std::uint64_t original_bytes, std::uint16_t link_type,
                   ReqId container, Packet& packet) {
  const bool cut = original_bytes > record.size();
  packet.link_type = link_type;
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
    case kLinkRadioFcs:
    case kLinkRadioNoFcs:
    case kLinkRadioTap: decode_radio(record, link_type, cut, packet); break;
    default:
      packet.framing = Framing::kBare;
      packet.error = fail(Fault::kUnsupported, 0, container).error;
      return;
  }
  // A serial frame's error counts from the kind byte, which precedes `bytes`.
  const std::size_t end = link_type == kLinkSerial ? record.size() : packet.bytes.size();
  if (cut) packet.error = fail(Fault::kCut, end, container).error;
}

}  // namespace rubric
