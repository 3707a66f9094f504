#include "conformance/check/input/read_packet.h"

#include "codec/generated/rubicon/tables.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/reflect/frame.h"
#include "codec/runtime/hdlc.h"

namespace rubric::check {

using reflect::Envelope;

bool observe_packet(const Packet& packet, RunStorage& storage, Observation& out) {
  static const reflect::FrameDecoder decoder(rubicon::tables::kProtocol);
  const Envelope read = decoder.open(packet);
  const bool radio = packet.framing == Framing::kRadio;
  if (radio ? read.mac.present : packet.serial_seq != kAbsent) {
    out.dsn = radio ? read.mac.dsn : static_cast<std::uint8_t>(packet.serial_seq);
    out.has_dsn = true;
  }
  if (read.error.fault != Fault::kNone) {
    out.kind = Observation::Kind::kDamaged;
    out.broken = read.error.requirement;
    return true;
  }
  if (read.kind == Envelope::Kind::kLinkAck) {
    out.kind = Observation::Kind::kLinkAck;
    return true;
  }
  if (read.kind != Envelope::Kind::kMessage) return false;
  constexpr auto kAckRequest = static_cast<unsigned>(tinyos::FrameControlPart::kAckRequest);
  out.kind = radio ? Observation::Kind::kRadio : Observation::Kind::kSerial;
  out.ack_request = radio ? (read.mac.fcf & kAckRequest) != 0 : packet.kind == kSerialPacketAck;
  out.pan = read.mac.destpan;
  out.frame = {radio ? machine::Link::kRadio : machine::Link::kSerial, read.am.dest, read.am.src,
               read.am.type, storage.keep(read.payload)};
  return true;
}

}  // namespace rubric::check
