// Handles received frames: decides whether they are for the node, who handles them, and when.
#pragma once

#include "codec/generated/rubicon/learning_notification.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"
#include "conformance/node/node.h"
#include "conformance/node/wire.h"

namespace rubric {
namespace node {

// Returns whether a component is above the transport level; Connectionless reaches no others.
inline bool is_application(uint8_t app_id) {
  return app_id == number(rubicon::Component::kMockup) ||
         app_id == number(rubicon::Component::kLearning) ||
         app_id == number(rubicon::Component::kApplicationMd) ||
         app_id == number(rubicon::Component::kControlLayer) ||
         app_id == number(rubicon::Component::kEsnData);
}

// Reads the number in the body of an ack, in the paper's form or in release 1.0's (decision 108);
// returns false if it is neither. A sink of release 1.0 sets nbytes to 102, so that bytes follow
// it.
inline bool acked_number(Bytes body, uint16_t& seq_num) {
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

inline bool Node::is_for_me(Line line, uint16_t dest) const {
  if (line == Line::kSerial) return role_ != Role::kMote;  // Mostly it names nobody.
  if (line == Line::kRadio && is_base_station()) return false;
  if (line == Line::kPeis && !is_base_station()) return false;
  return dest == kBroadcast || dest == (line == Line::kRadio ? id_ : island_);
}

inline bool Node::is_known(Line line, uint8_t type) const {
  if (type == kAmNet) return true;
  if (line == Line::kRadio) return type == kAmJoin || type == kAmJoinReply || type == kAmAckJoin;
  return is_sink() && type == kAmConfig;
}

inline void Node::received(Line line, Bytes packet) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  if (!header || !at(line).on) return;
  if (!is_for_me(line, header->dest()) || !is_known(line, header->type())) return;
  const Bytes rest = packet.from(kAmHeaderBytes);
  if (rest.size() < header->length() || header->length() > kAmPayloadMax) return;
  const Bytes payload = rest.first(header->length());
  if (application_busy_) return wait(line, header->src(), header->type(), payload);
  handle(line, header->src(), header->type(), payload);
}

inline void Node::wait(Line line, uint16_t src, uint8_t type, Bytes payload) {
  Queue in = at(line).in();
  //= N2-IN-FULL: A message that finds the incoming buffer full is dropped; those queued before it
  //= are neither changed nor lost, and later messages are handled.
  if (in.full()) return;
  Message& message = in.push();
  message.set_header(id_, src, type, payload.size());
  message.set_arrival(arrivals_++);
  memcpy(message.room(), payload.data(), payload.size());
}

inline void Node::handle_waiting() {
  //= N2-IN-ORDER: Messages that arrived while the application was busy are handled in the order of
  //= their arrival, each once.
  while (!application_busy_) {
    LineState* first = nullptr;
    Line line = Line::kRadio;
    for (uint8_t i = 0; i < kLines; ++i) {
      if (lines_[i].in().empty()) continue;
      const uint8_t arrival = lines_[i].in().front().arrival();
      if (first != nullptr && static_cast<int8_t>(arrival - first->in().front().arrival()) > 0) {
        continue;
      }
      first = &lines_[i];
      line = static_cast<Line>(i);
    }
    if (first == nullptr) return;
    const Message& message = first->in().front();
    handle(line, message.src(), message.type(), message.payload());
    first->in().pop();
  }
}

inline void Node::handle(Line line, uint16_t src, uint8_t type, Bytes payload) {
  if (type == kAmNet) return hear_net_msg(line, payload);
  if (type == kAmJoin) return hear_join_request(src, payload);
  if (type == kAmJoinReply) return hear_join_reply(src, payload);
  if (type == kAmAckJoin) return hear_ack_join(src, payload);
  hear_config(payload);
}

inline Node::Route Node::route_radio(Address dest, Address src) const {
  const Address own = address();
  Route route = Route();
  const bool here = dest.pid == own.pid || dest.pid == kBroadcast;
  //= N5-DELIVER: A mote delivers a net_msg, sent or sent on by a node of its island, whose dest is
  //= its island and its own devid or the broadcast devid.
  //= N6-DELIVER: A sink delivers a net_msg from the radio, sent by a node of its island, whose dest
  //= is its island and its own devid or the broadcast devid.
  route.deliver = here && (dest.devid == own.devid || dest.devid == kBroadcast);
  if (!is_sink()) return route;
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

inline Node::Route Node::route_serial(Address dest) const {
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

// The lines of a PC: to its sink, and to the other base stations.
inline Node::Route Node::route_to_pc_lines(Address dest) const {
  Route route = Route();
  //= N8-DELIVER: A base station delivers a message with dest <its island, NULL> to its application.
  route.deliver = dest == address();
  route.onward = !route.deliver && dest.pid != kBroadcast;  // No line reaches every island.
  //= N8-SERIAL: A base station sends a message for a mote of its own island over serial to its
  //= sink.
  //= N8-PEIS: A base station sends a message for another island, its own or its sink's, through
  //= PEIS to that island's base station.
  //= N8-LOOP: A base station does not hand a message for another island to its own sink.
  route.line = dest.pid == island_ ? Line::kSerial : Line::kPeis;
  route.am_dest = dest.pid == island_ ? kSinkId : dest.pid;
  return route;
}

inline Node::Route Node::route_received(Line line, Address dest, Address src) const {
  if (is_base_station()) {
    Route route = route_to_pc_lines(dest);
    if (route.line == line) route.onward = false;  // Never back to where it came from.
    return route;
  }
  return line == Line::kRadio ? route_radio(dest, src) : route_serial(dest);
}

inline void Node::hear_net_msg(Line line, Bytes payload) {
  //= J11-HEAR: A mote that is not a member ignores the net_msg that it hears.
  if (!is_member()) return;
  //= N11-NBYTES: A net_msg whose nbytes is over 102, under 2, or more than arrived is dropped: no
  //= delivery, no ack, no forward.
  const auto message = rubicon::NetMsgView::parse(payload);
  if (!message) return;
  const Address dest = address_of(message->dest());
  const Route route = route_received(line, dest, address_of(message->src()));
  if (route.onward) forward(route, *message);
  if (route.deliver) deliver(*message);
}

inline void Node::forward(const Route& route, rubicon::NetMsgView message) {
  Message* const place = take_place(route.line);
  if (place == nullptr) return;
  //= N6-CONTENT: What a sink forwards keeps addresses, reliable, sequence number and payload; on
  //= the serial line only nbytes and the bytes after the payload may differ.
  //= N7-CONTENT: What a sink sends on by radio keeps addresses, reliable, sequence number, nbytes
  //= and payload, and no byte after the payload.
  //= N8-INCOMING: A base station hands a message from PEIS for a mote of its island to its sink
  //= with addresses, reliable, sequence number and payload kept.
  const Bytes bytes = message.bytes();
  memcpy(place->room(), bytes.data(), bytes.size());
  send_net_msg(route.line, *place, route.am_dest, bytes.size());
}

// The message dispatcher.
inline void Node::deliver(rubicon::NetMsgView message) {
  const Bytes payload = message.payload();
  const uint8_t trans_id = number(rubicon::AppMsgLayout::TransIdAt::load(payload.data()));
  const uint8_t app_id = number(rubicon::AppMsgLayout::AppIdAt::load(payload.data()));
  const Bytes body = payload.from(kAppHeaderBytes);
  const Address src = address_of(message.src());
  //= T1-UNKNOWN: A message with an unknown TRANSID or APPID is dropped without harm.
  if (trans_id == number(rubicon::Component::kConnless)) {
    if (is_application(app_id)) hear_connless(message, app_id, body);
  } else if (trans_id == number(rubicon::Component::kRubiconAck)) {
    uint16_t seq_num;
    if (acked_number(body, seq_num)) awaiting_.hear(src, app_id, seq_num, application_);
  } else if (trans_id == number(rubicon::Component::kSynChannel)) {
    channels_.hear(address(), src, body, application_);
  }
}

inline void Node::hear_connless(rubicon::NetMsgView message, uint8_t app_id, Bytes data) {
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
  //= T2-CONTENT: An ack has TRANSID RUBICON_ACK, the APPID and the sequence number of a message to
  //= the node itself, is unreliable, and goes to the message's source.
  send_own({src, number(rubicon::Component::kRubiconAck), app_id, false, Bytes(body)});
}

}  // namespace node
}  // namespace rubric
