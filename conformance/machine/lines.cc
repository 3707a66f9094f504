#include "conformance/machine/lines.h"

#include <algorithm>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/transport.h"

namespace rubric::machine {
namespace {

// Calls `use` with the line; both lines have the same members, but not the same type.
template <class Use>
auto with_line(State& state, Link link, Use use) {
  return link == Link::kRadio ? use(state.radio) : use(state.serial);
}
template <class Use>
auto with_line(const State& state, Link link, Use use) {
  return link == Link::kRadio ? use(state.radio) : use(state.serial);
}

std::uint16_t am_source(const State& state, Link link) {
  if (link == Link::kRadio) return state.config.id;
  return link == Link::kPeis ? state.island : 0;
}

// Starts the times that count from when the line takes a frame: the period of a join_request, and
// the timeout of a reliable message.
void left(Node& node, Link link, std::uint8_t type, std::uint16_t awaited) {
  if (awaited != kNoSeq) start_ack_timer(node.state.awaited, node.profile(), node.now, awaited);
  JoinMote& join = node.state.join;
  if (link != Link::kRadio || type != am::kJoin || join.phase != JoinMote::Phase::kJoining) return;
  //= J8-PERIOD: A join_request follows the one before it no earlier than the join timeout.
  join.due = node.now + node.profile().join_period_ticks;
  join.asked = true;
}

// Returns whether a repeated ack_join has waited too long to be sent.
bool is_stale(const Node& node, const Buffered& frame) {
  const JoinMote& join = node.state.join;
  return frame.type == am::kAckJoin && join.acks > 1 &&
         node.now - join.accepted > node.profile().join_period_ticks;
}

//= J3-TIME: cur_time of a join_reply is the sink's clock in ms when it replies; it does not stand
//= still for a second or more between replies.
//= J3-DRIFT: Between two join_replies cur_time grows as time did, to within a second.
// Sets the time of a reply that waited for the radio to that at which it leaves.
void set_time(std::uint8_t* join_reply, const Node& node) {
  rubicon::JoinReplyLayout::CurTimeAt::store(join_reply, clock_ms(node));
}

template <std::size_t kRoom>
void flush_line(Node& node, Interface<kRoom>& line, Link link) {
  //= N2-BUSY: While a line is busy nothing is sent on it.
  while (line.on && !line.sending && !line.taken && !line.out.empty()) {
    const Buffered& frame = line.out.front();
    if (is_stale(node, frame)) {
      node.actions.ignored("J4-REPEAT"_rule);
      line.out.pop();
      continue;
    }
    //= N2-ORDER: Messages leave each line in the order in which they were accepted for it.
    Transmit& transmit = node.actions.transmit(frame.requirement);
    transmit.link = link;
    transmit.link_ack = frame.link_ack;
    transmit.type = frame.type;
    transmit.size_bytes = frame.size_bytes;
    transmit.dest = frame.dest;
    transmit.src = frame.src;
    //= N2-ONCE: A message that send accepted is sent once and unchanged.
    std::copy_n(frame.payload.begin(), frame.size_bytes, transmit.payload.begin());
    if (frame.type == am::kJoinReply) set_time(transmit.payload.data(), node);
    line.sending = true;
    line.sending_ack_join = frame.type == am::kAckJoin;
    left(node, link, frame.type, frame.awaited);
    line.out.pop();
    node.actions.followed("N2-ORDER"_rule);
  }
}

Place transmit_now(Node& node, const Header& header) {
  Transmit& transmit = node.actions.transmit(header.requirement);
  transmit.link = header.link;
  transmit.link_ack = header.link_ack;
  transmit.type = header.type;
  transmit.dest = header.dest;
  transmit.src = am_source(node.state, header.link);
  return {transmit.payload.data(), &transmit.size_bytes};
}

template <std::size_t kRoom>
Place put_on_line(Node& node, Interface<kRoom>& line, const Header& header) {
  //= N2-QUEUE: A message that send accepted while the radio or the serial line was busy is sent
  //= when the line is free again.
  if (!line.sending && !line.taken && line.out.empty()) {
    line.sending = true;
    line.sending_ack_join = header.type == am::kAckJoin;
    left(node, header.link, header.type, header.awaited);
    return transmit_now(node, header);
  }
  node.actions.followed("N2-QUEUE"_rule);
  Buffered& frame = line.out.push();
  frame.dest = header.dest;
  frame.src = am_source(node.state, header.link);
  frame.type = header.type;
  frame.link_ack = header.link_ack;
  frame.awaited = header.awaited;
  frame.requirement = header.requirement;
  return {frame.payload.data(), &frame.size_bytes};
}

}  // namespace

bool has_line(Role role, Link link) {
  if (link == Link::kSerial) return true;
  return (link == Link::kRadio) == (role != Role::kBaseStation);
}

ReqId line_refusal(const State& state, Link link) {
  if (link == Link::kPeis) return ReqId::kNone;
  return with_line(state, link, [](const auto& line) {
    //= N10-OFF: An interface that is switched off sends nothing and receives nothing.
    if (!line.on) return "N10-OFF"_rule;
    //= N1-FULL: When the outgoing buffer is full send returns 0xFFFF and that message is never
    //= sent.
    return line.out.full() ? "N1-FULL"_rule : ReqId::kNone;
  });
}

Place put(Node& node, const Header& header) {
  const ReqId refusal = line_refusal(node.state, header.link);
  if (refusal != ReqId::kNone) {
    node.actions.ignored(refusal);
    return {};
  }
  if (header.link == Link::kPeis) {
    left(node, header.link, header.type, header.awaited);
    return transmit_now(node, header);
  }
  return with_line(node.state, header.link,
                   [&](auto& line) { return put_on_line(node, line, header); });
}

void flush(Node& node, Link link) {
  with_line(node.state, link, [&](auto& line) { flush_line(node, line, link); });
}

void forget_waiting(State& state, std::uint8_t type) {
  auto& out = state.radio.out;
  for (std::size_t i = out.size(); i-- > 0;) {
    if (out[i].type == type) out.erase(i);
  }
}

bool is_waiting(const State& state, std::uint8_t type) {
  const auto& out = state.radio.out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i].type == type) return true;
  }
  return false;
}

void send_done(Node& node, const SendDone& event) {
  const auto end = [](auto& line) {
    const bool was = line.sending;
    line.sending = false;
    return was;
  };
  const bool was_sending = event.link != Link::kPeis && with_line(node.state, event.link, end);
  if (!was_sending) return node.actions.ignored(ReqId::kNone);  // Perhaps of before a reboot.
  if (event.link == Link::kRadio && node.state.radio.sending_ack_join) {
    node.state.radio.sending_ack_join = false;
    const JoinContext context = join_context(node);
    const JoinSend send = ack_join_sent(node.state.join, context, event.acked, node.actions);
    // The repeat keeps its frame's place before those that came later.
    if (send == JoinSend::kAck) send_ack_join(node, "J4-REPEAT"_rule);
  }
  flush(node, event.link);
}

void line_busy(Node& node, const LinkBusy& event) {
  if (event.link == Link::kPeis) return node.actions.ignored(ReqId::kNone);
  with_line(node.state, event.link, [&](auto& line) { line.taken = event.busy; });
  flush(node, event.link);
}

void send_join_request(Node& node, ReqId requirement) {
  // While the one before still waits for the radio it covers this one, too.
  if (is_waiting(node.state, am::kJoin)) return node.actions.followed("J8-PERIOD"_rule);
  const JoinMote& join = node.state.join;
  //= J1-DEST: A join_request is sent to the AM address of the sink, 1.
  const Place place =
      put(node, {Link::kRadio, am::kJoin, node.profile().sink_id, requirement, false});
  if (!place) return;
  rubicon::JoinRequest request;
  request.seq_num = join.seq_num;
  request.mote_desc = wire_of(join.descriptor);
  rubicon::JoinRequestLayout::store(request, place.payload);
  *place.size_bytes = rubicon::JoinRequestView::kMaxSizeBytes;
}

void send_ack_join(Node& node, ReqId requirement) {
  const JoinMote& join = node.state.join;
  //= J4-CONTENT: ack_join has dest <island, sink> of the accepted reply, src the new address, the
  //= request's sequence number and the descriptor of the request, and goes to the sink's AM
  //= address.
  rubicon::AckJoin ack;
  ack.dest = wire_of(Address{join.address.pid, join.sink_devid});
  ack.src = wire_of(join.address);
  ack.seq_num = join.seq_num;
  ack.mote_desc = wire_of(join.descriptor);
  Interface<4>& radio = node.state.radio;
  const Header header{Link::kRadio, am::kAckJoin, join.sink_devid, requirement, true};
  Place place;
  if (join.acks > 1 && radio.on && !radio.sending && !radio.taken) {
    radio.sending = radio.sending_ack_join = true;
    place = transmit_now(node, header);
  } else {
    place = put(node, header);
  }
  if (!place) return;
  rubicon::AckJoinLayout::store(ack, place.payload);
  *place.size_bytes = rubicon::AckJoinView::kMaxSizeBytes;
}

void send_join_reply(Node& node, std::uint16_t dest, std::uint16_t seq_num) {
  //= J3-DEST: A join_reply is sent to the AM address that asked.
  //= J3-ONCE: A sink sends at most one join_reply for each join_request, and none without one.
  // Called once for each request that hear_request() accepts.
  const Place place = put(node, {Link::kRadio, am::kJoinReply, dest, "J3-REPLY"_rule, false});
  if (!place) return;
  //= J3-SEQ: A join_reply carries the sequence number of the request that it answers.
  //= J3-ADDRESS: A join_reply carries the sink's island id as island_addr and the requesting mote's
  //= TinyOS id as mote_addr.
  rubicon::JoinReply reply;
  reply.island_addr = node.state.island;
  reply.mote_addr = dest;
  reply.cur_time = clock_ms(node);
  reply.seq_num = seq_num;
  rubicon::JoinReplyLayout::store(reply, place.payload);
  *place.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
}

}  // namespace rubric::machine
