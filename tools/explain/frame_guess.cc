#include "tools/explain/frame_guess.h"

#include <algorithm>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/mac_ack.h"
#include "codec/generated/tinyos/mac_header.h"
#include "codec/runtime/hdlc.h"

namespace rubric::explain {
namespace {

using ByteList = std::vector<std::uint8_t>;

constexpr std::size_t kFcsBytes = 2;

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
  using Header = tinyos::AmHeaderLayout;
  constexpr std::size_t kHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;
  return bytes.size() >= kHeaderBytes &&
         Header::DispatchAt::load(bytes.data()) == tinyos::Dispatch::kActiveMessage &&
         Header::LengthAt::load(bytes.data()) == bytes.size() - kHeaderBytes;
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
  Packet packet;
  decode_radio_record(view(given), kLinkRadioFcs, packet);
  return given.size() > kFcsBytes && packet.fcs == fcs_fast(packet.bytes);
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
  using tinyos::FrameControl;
  const auto start = tinyos::MacAckView::parse(view(given));
  if (!start) return false;
  if (start->fcf() == static_cast<std::uint16_t>(FrameControl::kAck)) {
    return given.size() <= tinyos::MacAckView::kMaxSizeBytes + kFcsBytes;
  }
  constexpr auto kShape = static_cast<unsigned>(tinyos::FrameControlPart::kShape);
  return (start->fcf() & kShape) == static_cast<unsigned>(FrameControl::kData) &&
         given.size() > tinyos::MacHeaderView::kMaxSizeBytes;
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
  const bool is_kind =
      first == kSerialAck || first == kSerialPacketAck || first == kSerialPacketNoAck;
  if (is_kind) return serial(given);
  if (first == 0) return packet(given);
  return std::nullopt;
}

}  // namespace rubric::explain
