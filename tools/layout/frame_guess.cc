#include "tools/layout/frame_guess.h"

#include <algorithm>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/runtime/hdlc.h"

namespace rubric::layout {
namespace {

using ByteList = std::vector<std::uint8_t>;

constexpr std::size_t kAmHeaderBytes = 8;
constexpr std::size_t kAmLengthAt = 5;
constexpr std::size_t kMacHeaderBytes = 9;
constexpr std::size_t kFcsBytes = 2;
constexpr std::uint16_t kShapeMask = 0xcc4f;  // IEEE 802.15.4-2006, section 7.2.1.1.
constexpr std::uint16_t kShapeShortAddresses = 0x8841;
constexpr std::uint16_t kFcfAck = 0x0002;

Bytes view(const ByteList& bytes) { return {bytes.data(), bytes.size()}; }

// Removes the flags around and the escapes within, as on the line itself.
ByteList without_flags(const ByteList& given) {
  ByteList content;
  std::size_t begin = 0;
  std::size_t end = given.size();
  while (begin < end && given[begin] == kHdlcFlag) ++begin;
  while (end > begin && given[end - 1] == kHdlcFlag) --end;
  if (begin == 0 && end == given.size()) return given;
  bool escaping = false;
  for (std::size_t i = begin; i < end; ++i) {
    if (given[i] == kHdlcEscape && !escaping) {
      escaping = true;
      continue;
    }
    content.push_back(static_cast<std::uint8_t>(given[i] ^ (escaping ? kHdlcXor : 0)));
    escaping = false;
  }
  return content;
}

GivenFrame serial(const ByteList& given) {
  GivenFrame frame;
  frame.bytes = without_flags(given);
  frame.what = "a serial frame, from its kind byte to its CRC";
  decode_serial_content(view(frame.bytes), frame.packet);
  return frame;
}

bool is_am(const ByteList& bytes) {
  return bytes.size() >= kAmHeaderBytes && bytes[0] == 0 &&
         bytes[kAmLengthAt] == bytes.size() - kAmHeaderBytes;
}

GivenFrame packet(const ByteList& given) {
  GivenFrame frame;
  frame.bytes = given;
  frame.what = "a serial packet, from its dispatch byte on";
  const bool counted = given.size() > 1 && given[0] == given.size() - 1;
  if (!is_am(given) && counted && is_am(ByteList(given.begin() + 1, given.end()))) {
    frame.bytes.erase(frame.bytes.begin());
    frame.what = "a serial forwarder packet, its length byte taken off";
  }
  frame.packet.framing = Framing::kSf;
  frame.packet.bytes = view(frame.bytes);
  return frame;
}

bool has_fcs(const ByteList& given) {
  if (given.size() <= kFcsBytes) return false;
  const Bytes all = view(given);
  const std::size_t size = given.size() - kFcsBytes;
  return fcs_fast(all.first(size)) == load_le16(all.data() + size);
}

GivenFrame radio(const ByteList& given) {
  GivenFrame frame;
  frame.bytes = given;
  const bool fcs = has_fcs(given);
  frame.what = fcs ? "an 802.15.4 frame with its FCS" : "an 802.15.4 frame without FCS";
  decode_radio_record(view(frame.bytes), fcs ? kLinkRadioFcs : kLinkRadioNoFcs, frame.packet);
  return frame;
}

bool begins_as_radio(const ByteList& given) {
  if (given.size() < 3) return false;
  const std::uint16_t fcf = load_le16(given.data());
  if (fcf == kFcfAck) return given.size() <= 5;
  return (fcf & kShapeMask) == kShapeShortAddresses && given.size() > kMacHeaderBytes;
}

GivenFrame bare(const ByteList& given) {
  GivenFrame frame;
  frame.bytes = given;
  frame.packet.framing = Framing::kBare;
  frame.packet.bytes = view(frame.bytes);
  return frame;
}

}  // namespace

std::optional<GivenFrame> take_frame(const ByteList& given, std::string_view framing) {
  if (framing == "hdlc") return serial(given);
  if (framing == "sf") return packet(given);
  if (framing == "radio") return radio(given);
  if (framing == "bare") return bare(given);
  const ByteList content = without_flags(given);
  if (given.size() != content.size()) return serial(given);
  if (check_serial_content(view(given)).fault == Fault::kNone) return serial(given);
  if (begins_as_radio(given) && has_fcs(given)) return radio(given);
  const GivenFrame as_packet = packet(given);
  if (is_am(as_packet.bytes)) return packet(given);
  if (begins_as_radio(given)) return radio(given);
  if (given.empty()) return std::nullopt;
  const std::uint8_t first = given[0];
  const bool is_kind = first == kSerialAck || first == kSerialPacketAck ||
                       first == kSerialPacketNoAck;
  if (is_kind) return serial(given);
  if (first == 0) return packet(given);
  return std::nullopt;
}

}  // namespace rubric::layout
