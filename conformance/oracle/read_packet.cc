#include "conformance/oracle/read_packet.h"

#include "codec/generated/tinyos/am_header.h"

namespace rubric::oracle {
namespace {

constexpr std::uint8_t kSerialAck = 0x43;
constexpr std::uint8_t kSerialPacketAck = 0x44;
constexpr std::uint8_t kNetworkLowpan = 0x3F;

// Frame control field, IEEE 802.15.4-2006, 7.2.1.1.
constexpr std::uint16_t kFcfTypeMask = 0x0007;
constexpr std::uint16_t kFcfData = 1;
constexpr std::uint16_t kFcfAck = 2;
constexpr std::uint16_t kFcfAckRequest = 0x0020;
constexpr std::uint16_t kFcfAddressing = 0xCC00;       // Modes of both addresses.
constexpr std::uint16_t kFcfShortAddresses = 0x8800;
constexpr std::uint16_t kFcfOnePan = 0x0040;
constexpr std::size_t kMacHeaderBytes = 9;  // FCF, DSN, PAN, two short addresses.

bool damaged(ReqId broken, Observation& out) {
  out.kind = Observation::Kind::kDamaged;
  out.broken = broken;
  return true;
}

bool observe_radio(Bytes bytes, RunStorage& storage, Observation& out) {
  if (bytes.size() < 3) return damaged("WIRE-RADIO-HEADER"_rule, out);
  const std::uint16_t fcf = load_le16(bytes.data());
  out.dsn = bytes[2];
  out.has_dsn = true;
  if ((fcf & kFcfTypeMask) == kFcfAck) {
    out.kind = Observation::Kind::kLinkAck;
    return true;
  }
  if ((fcf & kFcfTypeMask) != kFcfData) return false;
  const bool ours = (fcf & kFcfAddressing) == kFcfShortAddresses && (fcf & kFcfOnePan) != 0;
  if (!ours || bytes.size() < kMacHeaderBytes + 1) return false;
  out.kind = Observation::Kind::kRadio;
  out.ack_request = (fcf & kFcfAckRequest) != 0;
  out.pan = load_le16(bytes.data() + 3);
  out.frame.link = machine::Link::kRadio;
  out.frame.dest = load_le16(bytes.data() + 5);
  out.frame.src = load_le16(bytes.data() + 7);
  // An I-frame has the network byte before the type, a T-frame begins with the type. 0x3F itself
  // is no AM type of this protocol.
  const bool lowpan = bytes[kMacHeaderBytes] == kNetworkLowpan;
  const std::size_t type_at = kMacHeaderBytes + (lowpan ? 1 : 0);
  if (bytes.size() <= type_at) return damaged("WIRE-RADIO-HEADER"_rule, out);
  out.frame.type = bytes[type_at];
  out.frame.payload = storage.keep(bytes.from(type_at + 1));
  return true;
}

bool observe_am(Bytes bytes, RunStorage& storage, Observation& out) {
  if (bytes.empty() || bytes[0] != 0) return false;  // Another dispatch: not an active message.
  const auto header = tinyos::AmHeaderView::parse(bytes);
  if (!header) return damaged(header.error().requirement, out);
  const Bytes behind = bytes.from(tinyos::AmHeaderView::kMinSizeBytes);
  const std::size_t length = bytes[5];
  if (behind.size() < length) return damaged("WIRE-AM-LENGTH"_rule, out);
  out.kind = Observation::Kind::kSerial;
  out.frame.link = machine::Link::kSerial;
  out.frame.dest = load_be16(bytes.data() + 1);
  out.frame.src = load_be16(bytes.data() + 3);
  out.frame.type = bytes[7];
  out.frame.payload = storage.keep(behind.first(length));
  return true;
}

}  // namespace

bool observe_packet(const Packet& packet, RunStorage& storage, Observation& out) {
  if (packet.error.fault != Fault::kNone) return damaged(packet.error.requirement, out);
  switch (packet.framing) {
    case Framing::kRadio:
      return observe_radio(packet.bytes, storage, out);
    case Framing::kHdlc:
      if (packet.serial_seq != kAbsent) {
        out.dsn = static_cast<std::uint8_t>(packet.serial_seq);
        out.has_dsn = true;
      }
      if (packet.kind == kSerialAck) {
        out.kind = Observation::Kind::kLinkAck;
        return true;
      }
      out.ack_request = packet.kind == kSerialPacketAck;
      return observe_am(packet.bytes, storage, out);
    case Framing::kSf:
      return observe_am(packet.bytes, storage, out);
    case Framing::kBare:
      break;
  }
  return false;
}

}  // namespace rubric::oracle
