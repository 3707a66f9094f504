#include "codec/reflect/frame.h"

#include <algorithm>

#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/mac_ack.h"
#include "codec/generated/tinyos/mac_header.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/am_frames.h"
#include "codec/runtime/hdlc.h"

namespace rubric::reflect {
namespace {

using Am = tinyos::AmHeaderLayout;
using Mac = tinyos::MacHeaderLayout;
using tinyos::FrameControl;
using tinyos::FrameControlPart;

constexpr std::size_t kMacHeaderBytes = tinyos::MacHeaderView::kMaxSizeBytes;

const Field& last_field(const Type& type) { return type.fields[type.field_count - 1]; }

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

// Finds the message's fields: the last child of the carrier's structure, if decoding got that far;
// all fields of a frame whose headers nothing else shows.
void find_payload(Frame& out, bool is_am) {
  const Decoded& decoded = out.decoded;
  if (decoded.node_count() == 0) return;
  if (!is_am) {
    out.has_payload = true;
    return;
  }
  std::size_t last = 0;
  for (std::size_t i = 1; i < decoded[0].end; i = decoded[i].end) last = i;
  if (last && decoded[last].field == &last_field(*decoded[0].type)) {
    out.payload_node = static_cast<std::uint32_t>(last);
    out.has_payload = true;
  }
}

bool is_header(const Field& field, std::string_view name, std::string_view type) {
  return field.name == name && field.type && field.type->id == type;
}

}  // namespace

bool has_tinyos_headers(const Type& carrier) {
  const int count = carrier.field_count;
  const auto named = [&](int i, std::string_view name) { return carrier.fields[i].name == name; };
  if (count < 2 || !named(count - 1, "payload")) return false;
  if (is_header(carrier.fields[0], "am", "am_header")) return count == 2;
  return is_header(carrier.fields[0], "mac", "mac_header") && named(count - 2, "type") &&
         (count == 3 || (count == 4 && named(1, "network")));
}

const Switch* payload_choice(const Protocol& protocol, std::string_view carrier) {
  const Type* type = find_carrier(protocol, carrier);
  return type && type->field_count ? last_field(*type).choice : nullptr;
}

FrameDecoder::RadioCarrier::RadioCarrier(const Type* carrier) : type(carrier) {
  if (!type) return;
  is_am = has_tinyos_headers(*type);
  const Field& payload = last_field(*type);
  payload_at = static_cast<std::size_t>(payload.fixed_offset);
  type_at = static_cast<std::size_t>(payload.choice->key.steps[0].value);
  for (std::uint16_t i = 0; i < type->field_count; ++i) {
    const Field& field = type->fields[i];
    const bool first = field.fixed_offset == static_cast<std::int32_t>(kMacHeaderBytes);
    if (first && field.valid.kind == ValidKind::kOneOf) network = field.valid.one_of[0];
  }
}

FrameDecoder::FrameDecoder(const Protocol& protocol, const Type* bare)
    : protocol_(protocol),
      bare_(bare),
      serial_(find_carrier(protocol, "serial")),
      serial_is_am_(!serial_ || has_tinyos_headers(*serial_)),
      radio_i_(find_carrier(protocol, "radio_i")),
      radio_t_(find_carrier(protocol, "radio_t")),
      radio_ack_(find_carrier(tinyos::tables::kProtocol, "radio_ack")),
      radio_beacon_(find_carrier(protocol, "radio_beacon")),
      radio_command_(find_carrier(protocol, "radio_command")),
      radio_choice_(payload_choice(protocol, "radio_i")) {}

void FrameDecoder::decode(const Packet& packet, Frame& out) const {
  clear(out, packet);
  Envelope envelope;
  headers(packet, envelope);
  out.am = envelope.am;
  out.mac = envelope.mac;
  switch (envelope.kind) {
    case Envelope::Kind::kNothing: break;
    case Envelope::Kind::kOpaque: not_decoded(out, envelope.key); break;
    case Envelope::Kind::kLinkAck:
      if (envelope.carrier) decode_carrier(*envelope.carrier, packet.bytes, out.decoded);
      break;
    case Envelope::Kind::kMessage:
      decode_carrier(*envelope.carrier, packet.bytes, out.decoded);
      find_payload(out, envelope.is_am);
      break;
    case Envelope::Kind::kLink:
      reflect::decode(*envelope.carrier, packet.bytes, Tail::kFault, true, out.decoded);
      out.has_payload = true;
      break;
    case Envelope::Kind::kBare:
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

void FrameDecoder::decode_carrier(const Type& carrier, Bytes bytes, Decoded& out) const {
  const bool ack = &carrier == radio_ack_;
  const Switch* const more = &carrier == serial_ ? radio_choice_ : nullptr;
  reflect::decode(carrier, bytes, Tail::kFault, ack, out, more);
}

void FrameDecoder::serial_headers(Bytes bytes, Envelope& out) const {
  const std::uint8_t* p = bytes.data();
  if (serial_is_am_ && bytes.size() >= kAmHeaderBytes &&
      Am::DispatchAt::allows(p[Am::DispatchAt::kAt])) {
    out.am = {true,
              Am::DestAt::load(p),
              Am::SrcAt::load(p),
              Am::LengthAt::load(p),
              Am::GroupAt::load(p),
              Am::TypeAt::load(p)};
  }
  out.carrier = serial_;
  out.is_am = serial_is_am_;
  out.kind = serial_ ? Envelope::Kind::kMessage : Envelope::Kind::kOpaque;
}

/// Returns the carrier of beacons or commands, if frames with this frame control are laid out as
/// the versions of 2003 and 2006 have it, and are not secured.
const Type* FrameDecoder::link_carrier(std::uint16_t fcf) const {
  constexpr int kBeacon = 0, kCommand = 3;                         // IEEE 802.15.4-2006, 7.2.1.1.1.
  constexpr int kNewOrSecured = 0x2008;                            // 7.2.1.1.2, 7.2.1.1.7.
  constexpr int kAckRequest = 0x20, kOnePan = 0x40;                // 7.2.1.1.4, 7.2.1.1.5.
  const int to = fcf >> 10 & 3, from = fcf >> 14, type = fcf & 7;  // Addressing modes, 1 is none.
  if ((fcf & kNewOrSecured) != 0 || to == 1 || from == 1) return nullptr;
  if (type == kCommand) return radio_command_;
  const bool announces = to == 0 && from != 0 && (fcf & (kAckRequest | kOnePan)) == 0;
  return type == kBeacon && announces ? radio_beacon_ : nullptr;
}

void FrameDecoder::radio_headers(Bytes bytes, Envelope& out) const {
  const auto part = [](std::uint16_t fcf, FrameControlPart mask) {
    return fcf & static_cast<std::uint16_t>(mask);
  };
  constexpr auto kAck = static_cast<std::uint16_t>(FrameControl::kAck);
  constexpr auto kData = static_cast<std::uint16_t>(FrameControl::kData);
  const std::uint8_t* p = bytes.data();
  const std::uint16_t fcf = bytes.size() >= Mac::FcfAt::kEnd ? Mac::FcfAt::load(p) : kData;
  if (bytes.size() >= Mac::DsnAt::kEnd) {
    out.mac.present = true;
    out.mac.fcf = fcf;
    out.mac.dsn = Mac::DsnAt::load(p);
  }
  if (part(fcf, FrameControlPart::kType) == kAck) {
    out.kind = Envelope::Kind::kLinkAck;
    out.carrier = radio_ack_;
    return;
  }
  out.kind = Envelope::Kind::kOpaque;
  out.key = fcf;
  if (part(fcf, FrameControlPart::kShape) != kData) {
    out.carrier = link_carrier(fcf);
    if (out.carrier) out.kind = Envelope::Kind::kLink;
    return;
  }
  if (bytes.size() >= kMacHeaderBytes) {
    out.mac.has_addresses = true;
    out.mac.destpan = Mac::DestpanAt::load(p);
    out.mac.dest = Mac::DestAt::load(p);
    out.mac.src = Mac::SrcAt::load(p);
  }
  const bool longer = bytes.size() > kMacHeaderBytes;
  const bool i_frame = radio_i_.type && (!longer || p[kMacHeaderBytes] == radio_i_.network);
  if (i_frame && longer) {
    out.mac.has_network = true;
    out.mac.network = p[kMacHeaderBytes];
  }
  const RadioCarrier& carrier = i_frame ? radio_i_ : radio_t_;
  if (!carrier.type) {
    // What ends within its frame control field is of no kind: faulty, as the shortest frame is.
    if (bytes.size() < Mac::FcfAt::kEnd) {
      out.kind = Envelope::Kind::kLinkAck;
      out.carrier = radio_ack_;
    }
    return;
  }
  out.carrier = carrier.type;
  out.is_am = carrier.is_am;
  out.kind = Envelope::Kind::kMessage;
  if (bytes.size() < carrier.payload_at) return;
  out.am = {true,
            out.mac.dest,
            out.mac.src,
            static_cast<std::uint16_t>(bytes.size() - carrier.payload_at),
            static_cast<std::uint8_t>(out.mac.destpan),
            p[carrier.type_at]};
}

void FrameDecoder::headers(const Packet& packet, Envelope& out) const {
  out.key = packet.kind;
  switch (packet.framing) {
    case Framing::kHdlc:
      if (packet.kind == kSerialPacketAck || packet.kind == kSerialPacketNoAck) {
        serial_headers(packet.bytes, out);
      } else if (packet.kind == kSerialAck) {
        out.kind = Envelope::Kind::kLinkAck;
      } else if (packet.kind != kAbsent) {
        out.kind = Envelope::Kind::kOpaque;
      }
      break;
    case Framing::kSf: serial_headers(packet.bytes, out); break;
    case Framing::kRadio: radio_headers(packet.bytes, out); break;
    case Framing::kBare: out.kind = Envelope::Kind::kBare; break;
  }
}

Envelope FrameDecoder::open(const Packet& packet) const {
  Envelope out;
  headers(packet, out);
  out.error = packet.error;
  if (out.error.fault != Fault::kNone || !out.carrier) return out;
  const Bytes bytes = packet.bytes;
  bool sound = out.am.present;  // Of another frame of 802.15.4 nothing less than decoding it says.
  if (out.kind == Envelope::Kind::kLinkAck) {
    sound = bytes.size() == tinyos::MacAckView::kMaxSizeBytes;
  } else if (out.carrier == serial_) {
    sound = out.am.present && Am::LengthAt::allows(out.am.length) &&
            bytes.size() - kAmHeaderBytes == out.am.length;
  }
  if (sound) {
    if (out.am.present) out.payload = bytes.from(bytes.size() - out.am.length);
    return out;
  }
  out.error = fault_of(*out.carrier, bytes);
  return out;
}

__attribute__((cold, noinline)) Error FrameDecoder::fault_of(const Type& carrier,
                                                             Bytes bytes) const {
  Decoded decoded;
  decode_carrier(carrier, bytes, decoded);
  return decoded.error;
}

}  // namespace rubric::reflect
