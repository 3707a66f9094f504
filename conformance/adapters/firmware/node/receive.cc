// Handles received frames: decides whether they are for the node, who handles them, and when.
#include "codec/generated/rubicon/learning_notification.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"
#include "conformance/adapters/firmware/node/node.h"
#include "conformance/adapters/firmware/node/wire.h"

namespace rubric {
namespace firmware {
namespace {

using rubicon::Component;

// Returns whether a component is above the transport level; Connectionless reaches no others.
bool is_application(uint8_t app_id) {
  return app_id == number(Component::kMockup) || app_id == number(Component::kLearning) ||
         app_id == number(Component::kApplicationMd) ||
         app_id == number(Component::kControlLayer) || app_id == number(Component::kEsnData);
}

// Reads the number in the body of an ack, in the paper's form or in release 1.0's (decision 108);
// returns false if it is neither. A sink of release 1.0 sets nbytes to 102, so that bytes follow
// it.
bool acked_number(Bytes body, uint16_t& seq_num) {
  using Paper = rubicon::RubiconAckSeqOnlyLayout::SeqNumAt;
  using Ack = rubicon::RubiconAckLayout;
  const bool notification =
      body.size() >= rubicon::RubiconAckView::kMinSizeBytes &&
      number(Ack::TypeAt::load(body.data())) == number(rubicon::AmType::kLearningNotification);
  if (notification) {
    seq_num = Ack::SeqNumAt::load(body.data());
    return true;
  }
  if (body.size() != Paper::kEnd && body.size() != kAppDataMax) return false;
  seq_num = Paper::load(body.data());
  return true;
}

}  // namespace

void Node::radio_received(uint16_t dest, uint16_t src, uint8_t am_type, Bytes payload) {
  if (dest != id_ && dest != kBroadcast) return;
  receive(Line::kRadio, src, am_type, payload);
}

void Node::serial_received(Bytes packet) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  if (!kIsSink || !header) return;
  const Bytes payload = packet.from(kAmHeaderBytes);
  if (payload.size() < header->length()) return;
  receive(Line::kSerial, header->src(), header->type(), payload.first(header->length()));
}

void Node::receive(Line line, uint16_t src, uint8_t type, Bytes payload) {
  const bool join = type == kAmJoin || type == kAmJoinReply || type == kAmAckJoin;
  const bool known = type == kAmNet || (line == Line::kRadio ? join : kIsSink && type == kAmConfig);
  if (!line_of(line).on || !known || payload.size() > kAmPayloadMax) return;
  if (application_busy_) return wait(line, src, type, payload);
  handle(line, src, type, payload);
}

void Node::wait(Line line, uint16_t src, uint8_t type, Bytes payload) {
  Queue& in = line_of(line).in;
  //= N2-IN-FULL: A message that finds the incoming buffer full is dropped; those queued before it
  //= are neither changed nor lost, and later messages are handled.
  if (in.full()) return;
  Message& message = in.push();
  message.set_header(id_, src, type, payload.size());
  message.set_arrival(arrivals_++);
  memcpy(message.room(), payload.data(), payload.size());
}

void Node::handle_waiting() {
  //= N2-IN-ORDER: Messages that arrived while the application was busy are handled in the order of
  //= their arrival, each once.
  while (!application_busy_ && !(radio_.in.empty() && serial_.in.empty())) {
    const bool both = !radio_.in.empty() && !serial_.in.empty();
    const bool serial_first =
        both && static_cast<int8_t>(serial_.in.front().arrival() - radio_.in.front().arrival()) < 0;
    const Line line = radio_.in.empty() || serial_first ? Line::kSerial : Line::kRadio;
    const Message& message = line_of(line).in.front();
    handle(line, message.src(), message.type(), message.payload());
    line_of(line).in.pop();
  }
}

void Node::handle(Line line, uint16_t src, uint8_t type, Bytes payload) {
  if (type == kAmNet) return hear_net_msg(line, payload);
  if (type == kAmJoin) return hear_join_request(src, payload);
  if (type == kAmJoinReply) return hear_join_reply(src, payload);
  if (type == kAmAckJoin) return hear_ack_join(src, payload);
  hear_config(payload);
}

Node::Route Node::route_radio(Address dest, Address src) const {
  const Address own = address();
  Route route = Route();
  const bool here = dest.pid == own.pid || dest.pid == kBroadcast;
  //= N5-DELIVER: A mote delivers a net_msg, sent or sent on by a node of its island, whose dest is
  //= its island and its own devid or the broadcast devid.
  //= N6-DELIVER: A sink delivers a net_msg from the radio, sent by a node of its island, whose dest
  //= is its island and its own devid or the broadcast devid.
  route.deliver = here && (dest.devid == own.devid || dest.devid == kBroadcast);
  if (!kIsSink) return route;
  route.line = Line::kSerial;
  route.am_dest = kBroadcast;
  //= N6-FORWARD: A sink forwards a net_msg from the radio, sent by a node of its island, with dest
  //= <its island, NULL> to its base station over serial.
  const bool to_pc = dest.pid == own.pid && dest.devid == kNullDevid;
  //= N6-COLLISION: A sink ignores a net_msg from the radio whose dest.pid and src.pid are both
  //= foreign.
  const bool abroad = !here && src.pid == own.pid;
  route.onward = to_pc || abroad;
  return route;
}

Node::Route Node::route_serial(Address dest) const {
  const Address own = address();
  Route route = Route();
  const bool here = dest.pid == own.pid || dest.pid == kBroadcast;
  //= N6-ONCE: A sink forwards each received message once, and sends none that came by serial back
  //= over serial.
  if (here && dest.devid == kNullDevid) return route;
  //= N7-DELIVER: A sink delivers a net_msg from serial for its island whose devid is its own or the
  //= broadcast devid.
  // The base station is trusted with the island. (decision 126)
  route.deliver = dest.devid == own.devid || dest.devid == kBroadcast;
  //= N7-RADIO: A sink sends a net_msg from serial for its island whose devid is another mote, or
  //= the broadcast devid, on the radio to that devid.
  //= N7-FOREIGN: A sink does not send a net_msg from serial for another island on the radio.
  route.onward = here && dest.devid != own.devid;
  route.line = Line::kRadio;
  route.am_dest = dest.devid;
  return route;
}

void Node::hear_net_msg(Line line, Bytes payload) {
  //= J11-HEAR: A mote that is not a member ignores the net_msg that it hears.
  if (!is_member()) return;
  //= N11-NBYTES: A net_msg whose nbytes is over 102, under 2, or more than arrived is dropped: no
  //= delivery, no ack, no forward.
  const auto message = rubicon::NetMsgView::parse(payload);
  if (!message) return;
  const Address dest = address_of(message->dest());
  const Route route =
      line == Line::kRadio ? route_radio(dest, address_of(message->src())) : route_serial(dest);
  if (route.onward) forward(route, *message);
  if (route.deliver) deliver(*message);
}

void Node::forward(const Route& route, rubicon::NetMsgView message) {
  Message* const place = take_place(route.line);
  if (place == nullptr) return;
  //= N6-CONTENT: What a sink forwards keeps addresses, reliable, sequence number and payload; on
  //= the serial line only nbytes and the bytes after the payload may differ.
  //= N7-CONTENT: What a sink sends on by radio keeps addresses, reliable, sequence number, nbytes
  //= and payload, and no byte after the payload.
  const Bytes bytes = message.bytes();
  memcpy(place->room(), bytes.data(), bytes.size());
  send_net_msg(route.line, *place, route.am_dest, bytes.size());
}

// The message dispatcher.
void Node::deliver(rubicon::NetMsgView message) {
  const Bytes payload = message.payload();
  const uint8_t trans_id = number(rubicon::AppMsgLayout::TransIdAt::load(payload.data()));
  const uint8_t app_id = number(rubicon::AppMsgLayout::AppIdAt::load(payload.data()));
  const Bytes body = payload.from(kAppHeaderBytes);
  const Address src = address_of(message.src());
  //= T1-UNKNOWN: A message with an unknown TRANSID or APPID is dropped without harm.
  if (trans_id == number(Component::kConnless)) {
    if (is_application(app_id)) hear_connless(message, app_id, body);
  } else if (trans_id == number(Component::kRubiconAck)) {
    uint16_t seq_num;
    if (acked_number(body, seq_num)) awaiting_.hear(src, app_id, seq_num, application_);
  } else if (trans_id == number(Component::kSynChannel)) {
    channels_.hear(address(), src, body, application_);
  }
}

void Node::hear_connless(rubicon::NetMsgView message, uint8_t app_id, Bytes data) {
  const Address src = address_of(message.src());
  //= T1-DELIVER: The receiver takes TRANSID and APPID off and hands the rest and the source to the
  //= application that APPID names.
  application_.received(src, app_id, data);
  //= T2-UNRELIABLE: A message with reliable 0 is never acked.
  //= T2-BROADCAST: A broadcast is not acked.
  if (message.reliable() == 0 || address_of(message.dest()) != address()) return;
  rubicon::LearningNotification ack;
  ack.type = rubicon::AmType::kLearningNotification;
  ack.seq_num = message.seq_num();
  uint8_t body[rubicon::LearningNotificationView::kMaxSizeBytes];
  rubicon::LearningNotificationLayout::store(ack, body);
  //= T2-CONTENT: An ack has TRANSID RUBICON_ACK, the APPID and the sequence number of the message,
  //= is unreliable, and goes to the message's source.
  send_own({src, number(Component::kRubiconAck), app_id, false, Bytes(body)});
}

}  // namespace firmware
}  // namespace rubric
