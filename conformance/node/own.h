// Starts a node, and does what it does by itself: calls of its application, timers.
#pragma once

#include "codec/generated/rubicon/config.h"
#include "conformance/node/node.h"
#include "conformance/node/wire.h"

namespace rubric {
namespace node {

inline Node::LineState Node::borrowed(const Buffers& buffers, Line line) {
  Message* slots = buffers.messages;
  uint8_t i = 0;
  for (; i < static_cast<uint8_t>(line); ++i) slots += buffers.out[i] + buffers.in[i];
  return {slots, {buffers.out[i], 0, 0}, {buffers.in[i], 0, 0}, true, false, false, false};
}

inline Node::Node(Driver& driver, Application& application, const Buffers& buffers)
    : driver_(driver),
      application_(application),
      lines_{borrowed(buffers, Line::kRadio), borrowed(buffers, Line::kSerial),
             borrowed(buffers, Line::kPeis)},
      channels_(buffers.channels, buffers.channels_room),
      awaiting_(buffers.awaited, buffers.awaited_room),
      admissions_(buffers.admissions, buffers.members_max) {}

inline void Node::start(const Setup& setup) {
  for (LineState& line : lines_) {
    line.out().clear();
    line.in().clear();
    line.on = true;
    line.sending = line.busy = line.flushing = false;
  }
  channels_.reset(setup.channels);
  awaiting_.reset(setup.last_seq_num);
  admissions_.reset(setup.members);
  join_ = Join();
  now_ = setup.now;
  clock_offset_ms_ = 0 - time_ms();
  id_ = setup.id;
  island_ = setup.island;
  role_ = setup.role;
  slack_ = setup.slack;
  application_busy_ = sending_ack_join_ = false;
}

inline uint32_t Node::time_ms() const {
  return (now_ >> 7) * 125 + (((now_ & 127) * 125) >> 7);  // 1000 / 1024 is 125 / 128.
}

inline Address Node::address() const {
  if (is_base_station()) return {island_, kNullDevid};
  if (is_sink()) return {island_, id_};
  return {is_member() ? join_.island : uint16_t{0}, id_};
}

inline Ticks Node::phase() const {
  //= S2-PHASE: A mote's clock starts shifted by (devid - 1) * 30 ms.
  if (role_ != Role::kMote || id_ == 0) return 0;
  return static_cast<Ticks>(id_ - 1) * kSynapticPhaseTicks;
}

inline uint16_t Node::send(Address dest, uint8_t app_id, bool reliable, Bytes data) {
  //= N1-SIZE: send refuses more than 100 bytes of application data.
  if (data.size() > kAppDataMax) return kNoSeq;
  return send_own({dest, number(rubicon::Component::kConnless), app_id, reliable, data});
}

inline bool Node::set_interface(Line line, bool on) {
  if (line != Line::kRadio && line != Line::kSerial) return false;
  at(line).on = on;
  //= N10-ON: An interface that is switched on again sends and receives.
  flush(line);
  report_members();
  return true;
}

inline bool Node::set_island(uint16_t island) {
  if (!is_base_station() || is_reserved(island)) return false;
  Message* const message = take_place(Line::kSerial);
  if (message == nullptr) return false;
  rubicon::Config config;
  config.type = rubicon::CommandCode::kSetIslandId;
  config.value = island;
  rubicon::ConfigLayout::store(config, message->room());
  send_message(Line::kSerial, *message, kSinkId, kAmConfig, rubicon::ConfigView::kMaxSizeBytes);
  island_ = island;
  return true;
}

inline void Node::set_application_busy(bool busy) {
  application_busy_ = busy;
  handle_waiting();
}

// Routes a message of this node's own; returns false if it is refused.
inline bool Node::route_own(Address& dest, Route& route) const {
  //= J11-SEND: A mote that is not a member sends no net_msg.
  if (!is_member()) return false;
  const Address own = address();
  //= N3-LOCAL: dest.pid 0xFFFE (local island) is replaced by the sender's own island before the
  //= message is sent.
  if (dest.pid == kLocalIsland) dest.pid = own.pid;
  //= N4-SELF: A node refuses a message whose dest is the node itself.
  if (dest.pid == own.pid && (dest.devid == own.devid || dest.devid == kLocalMote)) return false;
  if (is_base_station()) {
    route = route_to_pc_lines(dest);
    return route.onward;
  }
  const bool here = (dest.pid == own.pid || dest.pid == kBroadcast) && dest.devid != kNullDevid;
  route.line = Line::kRadio;
  if (here) {
    //= N4-MOTE: On the radio a net_msg for a mote of the sender's own island is sent to that mote's
    //= AM address, a broadcast to AM address 0xFFFF.
    route.am_dest = dest.pid == kBroadcast ? kBroadcast : dest.devid;
  } else if (is_sink()) {
    //= N6-OWN: What a sink itself sends to <its island, NULL> or to another island goes over
    //= serial.
    route.line = Line::kSerial;
    route.am_dest = kBroadcast;
  } else {
    //= N4-SINK: A mote sends a net_msg for another island, or with devid NULL, to the AM address of
    //= its sink.
    route.am_dest = join_.sink;
  }
  return true;
}

inline uint16_t Node::send_own(const OwnMessage& own) {
  Address dest = own.dest;
  Route route = Route();
  if (!route_own(dest, route)) return kNoSeq;
  // An ack can be reported only if there is a place to remember that it is awaited.
  if (own.reliable && awaiting_.full()) return kNoSeq;
  Message* const message = take_place(route.line);
  //= N1-FULL: When the outgoing buffer is full send returns 0xFFFF and that message is never sent.
  if (message == nullptr) return kNoSeq;

  uint8_t* const body = message->room() + kNetHeaderBytes;
  rubicon::AppMsgLayout::TransIdAt::store(body, rubicon::Component(own.trans_id));
  rubicon::AppMsgLayout::AppIdAt::store(body, rubicon::Component(own.app_id));
  if (!own.data.empty()) memcpy(body + kAppHeaderBytes, own.data.data(), own.data.size());
  rubicon::NetMsg wire;
  wire.dest = wire_of(dest);
  //= N1-SRC: What a node sends on behalf of its applications carries the node's own address as src;
  //= a base station's src is <its island, NULL>.
  wire.src = wire_of(address());
  wire.reliable = own.reliable ? 1 : 0;
  wire.seq_num = awaiting_.next_seq_num();
  wire.payload = Bytes(body, kAppHeaderBytes + own.data.size());
  rubicon::NetMsgLayout::store(wire, message->room());
  if (own.reliable) awaiting_.add(wire.seq_num, own.app_id, dest);
  send_net_msg(route.line, *message, route.am_dest, kNetHeaderBytes + wire.payload.size());
  //= N1-SEQ: send returns the sequence number that the message carries.
  return wire.seq_num;
}

inline bool Node::run(Ticks now, Ticks& due) {
  now_ = now;
  if (join_.phase == Phase::kJoining && is_reached(join_.due, now)) join_timer_due();
  awaiting_.run(now, application_);
  if (channels_.tick(now)) tick();
  return next_due(due);
}

inline bool Node::next_due(Ticks& due) const {
  bool any = join_.phase == Phase::kJoining;
  due = join_.due;
  Ticks other = 0;
  if (awaiting_.next_due(other) && (!any || is_reached(other, due))) {
    due = other;
    any = true;
  }
  if (channels_.next_due(other) && (!any || is_reached(other, due))) {
    due = other;
    any = true;
  }
  return any;
}

inline void Node::tick() {
  const Address own = address();
  for (uint8_t i = 0; i < channels_.out_count(); ++i) {
    Channel& channel = channels_.out(i);
    if (!channels_.is_local(channel, own)) continue;
    if (channels_.takes_part(channel)) channels_.hand_over(channel, own);
  }
  channels_.signal_inputs(application_);
  for (uint8_t i = 0; i < channels_.out_count(); ++i) {
    Channel& channel = channels_.out(i);
    if (channels_.is_local(channel, own) || !channels_.takes_part(channel)) continue;
    send_values(channel);
  }
}

inline void Node::send_values(Channel& channel) {
  //= S2-SEND: At each tick every started output channel in reliable mode, but for a channel to
  //= itself, sends its values to its destination.
  //= S2-CONTENT: Synaptic data has TRANSID SYN_CHANNEL, APPID LEARNING or ESN_DATA, and one
  //= little-endian binary32 for each connection, in order, unreliable.
  const Address dest = {channel.peer_pid, static_cast<uint16_t>(channel.id)};
  const uint16_t sent =
      send_own({dest, number(rubicon::Component::kSynChannel), number(rubicon::Component::kEsnData),
                false, Bytes(channel.values, size_t{4} * channel.size)});
  // Refused for lack of room: the receiver would not know of a change before the next one.
  if (sent == kNoSeq) channel.fresh = true;
}

}  // namespace node
}  // namespace rubric
