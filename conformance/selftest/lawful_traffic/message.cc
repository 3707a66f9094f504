// Bytes of messages, written by the codec.
#include "conformance/selftest/lawful_traffic/message.h"

#include <cassert>
#include <utility>

namespace rubric::lawful {
namespace {

template <class Value>
Octets written(const Value& value) {
  std::uint8_t room[127];
  const auto out = rubicon::write(value, MutableBytes(room));
  assert(out);
  return Octets(out->data(), out->data() + out->size());
}

rubicon::RAddr raddr(Address address) {
  rubicon::RAddr out;
  out.pid = static_cast<rubicon::Pid>(address.pid);
  out.devid = static_cast<rubicon::Devid>(address.devid);
  return out;
}

rubicon::MoteDesc mote_desc(const Descriptor& descriptor) {
  rubicon::MoteDesc out;
  out.mote_type = static_cast<rubicon::MoteType>(descriptor.type);
  out.transducers = rubicon::TransducerMask(descriptor.transducers);
  out.actuators = rubicon::ActuatorMask(descriptor.actuators);
  return out;
}

}  // namespace

Octets encode(const NetMessage& message) {
  rubicon::NetMsg out;
  out.dest = raddr(message.dest);
  out.src = raddr(message.src);
  out.reliable = message.reliable ? 1 : 0;
  out.seq_num = message.seq;
  out.payload = view(message.payload);
  return written(out);
}

std::optional<NetMessage> decode_net(Bytes bytes) {
  const auto parsed = rubicon::NetMsgView::parse(bytes);
  if (!parsed) return std::nullopt;
  NetMessage out;
  out.dest = {static_cast<std::uint16_t>(parsed->dest().pid()),
              static_cast<std::uint16_t>(parsed->dest().devid())};
  out.src = {static_cast<std::uint16_t>(parsed->src().pid()),
             static_cast<std::uint16_t>(parsed->src().devid())};
  out.reliable = parsed->reliable() == 1;
  out.seq = parsed->seq_num();
  out.payload.assign(parsed->payload().begin(), parsed->payload().end());
  return out;
}

Octets join_request(std::uint16_t seq, const Descriptor& descriptor) {
  rubicon::JoinRequest out;
  out.seq_num = seq;
  out.mote_desc = mote_desc(descriptor);
  return written(out);
}

Octets join_reply(Address address, std::uint32_t cur_time_ms, std::uint16_t seq) {
  rubicon::JoinReply out;
  out.island_addr = address.pid;
  out.mote_addr = address.devid;
  out.cur_time = cur_time_ms;
  out.seq_num = seq;
  return written(out);
}

Octets ack_join(Address sink, Address mote, std::uint16_t seq, const Descriptor& descriptor) {
  rubicon::AckJoin out;
  out.dest = raddr(sink);
  out.src = raddr(mote);
  out.seq_num = seq;
  out.mote_desc = mote_desc(descriptor);
  return written(out);
}

Octets config(rubicon::CommandCode code, std::uint16_t value) {
  rubicon::Config out;
  out.type = code;
  out.value = value;
  return written(out);
}

Octets app_msg(rubicon::Component trans, std::uint8_t app, const Octets& body) {
  rubicon::AppMsg out;
  out.trans_id = trans;
  out.app_id = static_cast<rubicon::Component>(app);
  out.payload = view(body);
  return written(out);
}

Octets updates_body(const std::vector<std::pair<std::uint16_t, std::uint16_t>>& pairs) {
  rubicon::Updates out;
  out.type = rubicon::AmType::kUpdates;
  for (const auto& [bit, value] : pairs) {
    rubicon::TransducerUpdate update;
    update.transducer = rubicon::TransducerMask(bit);
    update.value = value;
    const bool taken = out.updates.push(update);
    assert(taken);
    (void)taken;
  }
  return written(out);
}

Octets demo_body(std::uint16_t transducers, std::uint16_t period_ms) {
  rubicon::Demo out;
  out.msg_type = 1;
  out.sensors_bitmask = rubicon::TransducerMask(transducers);
  out.period = period_ms;
  return written(out);
}

Octets demo_data_body(std::uint16_t reading) {
  rubicon::DemoData out;
  out.msg_type = rubicon::AmType::kDemoData;
  out.light = reading;
  out.temp = static_cast<std::uint16_t>(6400 + reading % 100);
  return written(out);
}

Octets ack_body_deployed(std::uint16_t seq) {
  rubicon::RubiconAck out;
  out.type = rubicon::AmType::kLearningNotification;
  out.seq_num = seq;
  return written(out);
}

Octets ack_body_paper(std::uint16_t seq) {
  rubicon::RubiconAckSeqOnly out;
  out.seq_num = seq;
  return written(out);
}

Octets synaptic_body(const std::vector<float>& values) {
  rubicon::SynapticData out;
  for (const float value : values) {
    const bool taken = out.values.push(value);
    assert(taken);
    (void)taken;
  }
  return written(out);
}

Octets serial_joined_body(Address mote, const Descriptor& descriptor) {
  rubicon::SerialJoined out;
  out.msg_type = rubicon::AmType::kSerialJoined;
  out.island_addr = mote.pid;
  out.mote_addr = mote.devid;
  out.mote_type = static_cast<rubicon::MoteType>(descriptor.type);
  out.transducers = rubicon::TransducerMask(descriptor.transducers);
  out.actuators = rubicon::ActuatorMask(descriptor.actuators);
  return written(out);
}

}  // namespace rubric::lawful
