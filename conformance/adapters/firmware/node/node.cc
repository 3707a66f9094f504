#include "conformance/adapters/firmware/node/node.h"

#include "conformance/adapters/firmware/node/wire.h"

namespace rubric {
namespace firmware {

void Node::start(const Setup& setup) {
  radio_ = LineState(Queue(radio_out_), Queue(radio_in_));
  serial_ = LineState(Queue(serial_out_), Queue(serial_in_));
  channels_.reset(setup.channels);
  awaiting_.reset(setup.last_seq_num);
  admissions_.clear();
  join_ = Join();
  clock_offset_ms_ = 0;
  id_ = setup.id;
  island_ = setup.island;
  application_busy_ = sending_ack_join_ = false;
  radio_port_.set_on(true);
  serial_port_.set_on(true);
}

uint32_t Node::uptime_ms() const {
  const Ticks now = clock_.now();  // 1000 / 1024 is 125 / 128.
  return (now >> 7) * 125 + (((now & 127) * 125) >> 7);
}

uint32_t Node::clock_ms() const { return uptime_ms() + clock_offset_ms_; }

Address Node::address() const {
  if (kIsSink) return {island_, id_};
  return {is_member() ? join_.island : uint16_t{0}, id_};
}

Ticks Node::phase() const {
  //= S2-PHASE: A mote's clock starts shifted by (devid - 1) * 30 ms.
  if (kIsSink || id_ == 0) return 0;
  return static_cast<Ticks>(id_ - 1) * kSynapticPhaseTicks;
}

uint16_t Node::send(Address dest, uint8_t app_id, bool reliable, Bytes data) {
  //= N1-SIZE: send refuses more than 100 bytes of application data.
  if (data.size() > kAppDataMax) return kNoSeq;
  return send_own({dest, number(rubicon::Component::kConnless), app_id, reliable, data});
}

void Node::set_interface(Line line, bool on) {
  line_of(line).on = on;
  if (line == Line::kRadio) {
    radio_port_.set_on(on);
  } else {
    serial_port_.set_on(on);
  }
  //= N10-ON: An interface that is switched on again sends and receives.
  flush(line);
  report_members();
}

void Node::set_application_busy(bool busy) {
  application_busy_ = busy;
  handle_waiting();
}

// Routes a message of this node's own; returns false if it is refused.
bool Node::route_own(Address& dest, Route& route) const {
  //= J11-SEND: A mote that is not a member sends no net_msg.
  if (!is_member()) return false;
  const Address own = address();
  //= N3-LOCAL: dest.pid 0xFFFE (local island) is replaced by the sender's own island before the
  //= message is sent.
  if (dest.pid == kLocalIsland) dest.pid = own.pid;
  //= N4-SELF: A node refuses a message whose dest is the node itself.
  if (dest.pid == own.pid && (dest.devid == own.devid || dest.devid == kLocalMote)) return false;
  const bool here = (dest.pid == own.pid || dest.pid == kBroadcast) && dest.devid != kNullDevid;
  route.line = Line::kRadio;
  if (here) {
    //= N4-MOTE: On the radio a net_msg for a mote of the sender's own island is sent to that mote's
    //= AM address, a broadcast to AM address 0xFFFF.
    route.am_dest = dest.pid == kBroadcast ? kBroadcast : dest.devid;
  } else if (kIsSink) {
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

uint16_t Node::send_own(const OwnMessage& own) {
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

void Node::run_timers() {
  const Ticks now = clock_.now();
  if (join_.phase == Phase::kJoining && is_reached(join_.due, now)) join_timer_due();
  awaiting_.run(now, application_);
  if (channels_.tick(now)) tick();
}

bool Node::next_due(Ticks& due) const {
  bool any = join_.phase == Phase::kJoining;
  due = join_.due;
  Ticks other;
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

void Node::tick() {
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

void Node::send_values(Channel& channel) {
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

}  // namespace firmware
}  // namespace rubric
