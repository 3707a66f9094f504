#include "codec/reflect/frame.h"

#include <algorithm>

#include "codec/generated/tinyos/tables.h"
#include "codec/runtime/hdlc.h"

namespace rubric::reflect {
namespace {

// IEEE 802.15.4-2006, section 7.2.1.1: frame type, security, PAN id compression, address modes.
constexpr std::uint16_t kFrameTypeMask = 0x0007;
constexpr std::uint16_t kFrameTypeAck = 2;
constexpr std::uint16_t kShapeMask = 0xcc4f;
constexpr std::uint16_t kShapeShortAddresses = 0x8841;
constexpr std::size_t kMacHeaderBytes = 9;
constexpr std::size_t kAmHeaderBytes = 8;
constexpr std::uint8_t kNalpNetwork = 0x3f;

void clear(Frame& out, const Packet& packet) {
  out.packet = &packet;
  out.am = ActiveMessage{};
  out.mac = MacHeader{};
  out.error = Error{Fault::kNone, 0, ReqId::kNone};
  out.payload_node = 0;
  out.has_payload = false;
  out.decoded.clear(packet.bytes);
}

void not_decoded(Frame& out, std::int64_t kind) {
  out.decoded.add_note({NoteKind::kNotDecoded, 0, nullptr, nullptr, kind});
}

// The message's fields are the last child of the carrier's structure, where decoding got that far.
void find_payload(Frame& out) {
  const Decoded& decoded = out.decoded;
  if (decoded.node_count() == 0) return;
  std::size_t last = 0;
  for (std::size_t i = 1; i < decoded[0].end; i = decoded[i].end) last = i;
  const Type* type = decoded[0].type;
  if (last && decoded[last].field == &type->fields[type->field_count - 1]) {
    out.payload_node = static_cast<std::uint32_t>(last);
    out.has_payload = true;
  }
}

}  // namespace

const Switch* payload_choice(const Protocol& protocol, std::string_view carrier) {
  const Type* type = find_carrier(protocol, carrier);
  return type && type->field_count ? type->fields[type->field_count - 1].choice : nullptr;
}

FrameDecoder::FrameDecoder(const Protocol& protocol, const Type* bare)
    : protocol_(protocol),
      bare_(bare),
      serial_(find_carrier(protocol, "serial")),
      radio_i_(find_carrier(protocol, "radio_i")),
      radio_t_(find_carrier(protocol, "radio_t")),
      radio_choice_(payload_choice(protocol, "radio_i")) {}

void FrameDecoder::decode(const Packet& packet, Frame& out) const {
  clear(out, packet);
  switch (packet.framing) {
    case Framing::kHdlc:
      if (packet.kind == kSerialPacketAck || packet.kind == kSerialPacketNoAck) {
        decode_serial(out);
      } else if (packet.kind != kAbsent && packet.kind != kSerialAck) {
        not_decoded(out, packet.kind);
      }
      break;
    case Framing::kSf: decode_serial(out); break;
    case Framing::kRadio: decode_radio(out); break;
    case Framing::kBare:
      if (bare_) {
        reflect::decode(*bare_, packet.bytes, Tail::kStale, true, out.decoded);
        out.has_payload = true;
      }
      break;
  }
  out.error = out.decoded.error;
  if (packet.error.fault == Fault::kNone) return;
  // The framing's fault comes first; its offset counts from the kind byte, or the length byte.
  out.error = packet.error;
  std::uint32_t head = 0;
  if (packet.framing == Framing::kHdlc) {
    head = (packet.kind != kAbsent) + (packet.serial_seq != kAbsent);
  } else if (packet.error.requirement == "WIRE-SF-LENGTH"_rule && packet.link_type == 0) {
    head = 1;  // A capture file's records have no length byte.
  }
  out.error.offset_bytes -= std::min(out.error.offset_bytes, head);
}

void FrameDecoder::decode_serial(Frame& out) const {
  const Bytes bytes = out.packet->bytes;
  if (bytes.size() >= kAmHeaderBytes && bytes[0] == 0) {
    const std::uint8_t* p = bytes.data();
    out.am = {true, load_be16(p + 1), load_be16(p + 3), p[5], p[6], p[7]};
  }
  if (!serial_) return not_decoded(out, out.packet->kind);
  reflect::decode(*serial_, bytes, Tail::kFault, false, out.decoded, radio_choice_);
  find_payload(out);
}

void FrameDecoder::decode_radio(Frame& out) const {
  const Bytes bytes = out.packet->bytes;
  const std::uint8_t* p = bytes.data();
  const std::uint16_t fcf = bytes.size() >= 2 ? load_le16(p) : kShapeShortAddresses;
  if (bytes.size() >= 3) {
    out.mac.present = true;
    out.mac.fcf = fcf;
    out.mac.dsn = p[2];
  }
  if ((fcf & kFrameTypeMask) == kFrameTypeAck) {
    const Type* ack = find_carrier(tinyos::tables::kProtocol, "radio_ack");
    reflect::decode(*ack, bytes, Tail::kFault, true, out.decoded);
    return;
  }
  if ((fcf & kShapeMask) != kShapeShortAddresses) return not_decoded(out, fcf);
  if (bytes.size() >= kMacHeaderBytes) {
    out.mac.has_addresses = true;
    out.mac.destpan = load_le16(p + 3);
    out.mac.dest = load_le16(p + 5);
    out.mac.src = load_le16(p + 7);
  }
  const bool i_frame = bytes.size() <= kMacHeaderBytes || p[kMacHeaderBytes] == kNalpNetwork;
  out.mac.has_network = i_frame && bytes.size() > kMacHeaderBytes;
  const std::size_t head = kMacHeaderBytes + (i_frame ? 2 : 1);
  if (bytes.size() >= head) {
    out.am = {true,
              out.mac.dest,
              out.mac.src,
              static_cast<std::uint16_t>(bytes.size() - head),
              static_cast<std::uint8_t>(out.mac.destpan),
              p[head - 1]};
  }
  const Type* carrier = i_frame ? radio_i_ : radio_t_;
  if (!carrier) return not_decoded(out, fcf);
  reflect::decode(*carrier, bytes, Tail::kFault, false, out.decoded);
  find_payload(out);
}

}  // namespace rubric::reflect
