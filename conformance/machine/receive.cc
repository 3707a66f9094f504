// Handles received frames: decides whether they are for the node, whether they wait, and who
// handles them.
#include <algorithm>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "conformance/machine/lines.h"
#include "conformance/machine/messages.h"

namespace rubric::machine {
namespace {

bool is_sink(const Node& node) { return node.config().role == Role::kSink; }

void hear_join_request(Node& node, const Frame& frame) {
  //= J10-MOTE: A mote ignores join_request and ack_join.
  if (!is_sink(node)) return node.actions.ignored("J10-MOTE"_rule);
  const auto request = rubicon::JoinRequestView::parse(frame.payload);
  if (!request) return node.actions.ignored(request.error().requirement);
  // No mote has such a TinyOS id, so no reply could name it. (decision 132)
  if (is_reserved(frame.src) || frame.src == node.config().id) {
    return node.actions.ignored("J3-ADDRESS"_rule);
  }
  const Descriptor descriptor = descriptor_of(request->mote_desc());
  const bool answer = hear_request(node.state.sink, join_context(node), frame.src,
                                   request->seq_num(), descriptor, node.actions);
  if (answer) send_join_reply(node, frame.src, request->seq_num());
}

void hear_join_reply(Node& node, const Frame& frame) {
  //= J10-SINK: A sink ignores join_reply.
  if (is_sink(node)) return node.actions.ignored("J10-SINK"_rule);
  const auto reply = rubicon::JoinReplyView::parse(frame.payload);
  if (!reply) return node.actions.ignored(reply.error().requirement);
  State& state = node.state;
  const Address offered{reply->island_addr(), reply->mote_addr()};
  //= J4-ADDRESS: A mote ignores a join_reply whose mote_addr is not its own TinyOS id or whose
  //= island_addr is reserved.
  if (offered.devid != node.config().id || is_reserved(offered.pid)) {
    return node.actions.ignored("J4-ADDRESS"_rule);
  }
  // Nor is a request outstanding that still waits for the radio: nobody can have answered it.
  if (state.join.phase == JoinMote::Phase::kJoining && !state.join.asked) {
    return node.actions.ignored("J4-JOINED"_rule);
  }
  const JoinSend send = hear_reply(state.join, join_context(node), offered, reply->seq_num(),
                                   frame.src, node.actions);
  if (send != JoinSend::kAck) return;
  //= J4-CLOCK: A mote that accepts a join_reply sets its clock to cur_time.
  state.clock_offset_ms = reply->cur_time() - ms_of(node);
  node.actions.followed("J4-CLOCK"_rule);
  forget_waiting(state, am::kJoin);  // J5-STOP.
  //= J4-ACK: A mote that accepts a join_reply sends ack_join.
  send_ack_join(node, "J4-ACK"_rule);
}

void hear_ack_join(Node& node, const Frame& frame) {
  if (!is_sink(node)) return node.actions.ignored("J10-MOTE"_rule);
  const auto ack = rubicon::AckJoinView::parse(frame.payload);
  if (!ack) return node.actions.ignored(ack.error().requirement);
  const Address src = address_of(ack->src());
  const Address dest = address_of(ack->dest());
  //= J6-SENDER: A sink ignores an ack_join whose dest.devid is not its own, or whose src is not
  //= <dest.pid, the AM source>.
  const bool sound = dest.devid == node.config().id && src == Address{dest.pid, frame.src};
  if (dest.pid == node.state.island && !sound) return node.actions.ignored("J6-SENDER"_rule);
  const bool joined = hear_ack_join(node.state.sink, join_context(node), dest, src, ack->seq_num(),
                                    descriptor_of(ack->mote_desc()), node.actions);
  if (joined) report_joined(node, *find_member(node.state.sink, src.devid));
}

void hear_config(Node& node, const Frame& frame) {
  const auto config = rubicon::ConfigView::parse(frame.payload);
  if (!config) return node.actions.ignored(config.error().requirement);
  //= N9-OTHER: A config message of another type, or with a reserved island id, changes nothing, and
  //= a base station sets no such id.
  if (config->type() != rubicon::CommandCode::kSetIslandId || is_reserved(config->value())) {
    return node.actions.ignored("N9-OTHER"_rule);
  }
  set_island(node, config->value());
}

// Returns whether a role listens to such frames; TinyOS drops the others first.
bool is_known_type(Role role, Link link, std::uint8_t type) {
  if (type == am::kNet) return true;
  if (link == Link::kSerial) return type == am::kConfig && role == Role::kSink;
  return link == Link::kRadio &&
         (type == am::kJoin || type == am::kJoinReply || type == am::kAckJoin);
}

void handle_by_type(Node& node, const Frame& frame) {
  switch (frame.type) {
    case am::kNet: return hear_net_msg(node, frame.link, frame.payload);
    case am::kJoin: return hear_join_request(node, frame);
    case am::kJoinReply: return hear_join_reply(node, frame);
    case am::kAckJoin: return hear_ack_join(node, frame);
    case am::kConfig: return hear_config(node, frame);
    default: return node.actions.ignored(ReqId::kNone);
  }
}

void handle(Node& node, const Frame& frame) {
  handle_by_type(node, frame);
  note_presence(node, frame);
}

// Returns whether the frame reaches the node: not if the line is off or the header names another
// node.
bool is_for_us(Node& node, const Frame& frame) {
  const State& state = node.state;
  const Role role = node.config().role;
  const bool has = frame.link == Link::kSerial ? role != Role::kMote : has_line(role, frame.link);
  bool on = true;
  bool addressed = true;  // The serial stack ignores it.
  if (frame.link == Link::kRadio) {
    on = state.radio.on;
    addressed = frame.dest == node.config().id || frame.dest == kAmBroadcast;
  } else if (frame.link == Link::kSerial) {
    on = state.serial.on;
  } else {
    addressed = frame.dest == state.island;
  }
  if (!has || !addressed) {
    // The hardware's filter, or TinyOS's: below this protocol's rules.
    node.actions.ignored(ReqId::kNone);
    return false;
  }
  //= N10-OFF: An interface that is switched off sends nothing and receives nothing.
  if (!on) node.actions.ignored("N10-OFF"_rule);
  return on;
}

template <std::size_t kRoom>
void wait(Node& node, Interface<kRoom>& line, const Frame& frame) {
  //= N2-IN-FULL: A message that finds the incoming buffer full is dropped; those queued before it
  //= are neither changed nor lost, and later messages are handled.
  if (line.in.full()) return node.actions.ignored("N2-IN-FULL"_rule);
  Buffered& buffered = line.in.push();
  buffered.dest = frame.dest;
  buffered.src = frame.src;
  buffered.type = frame.type;
  buffered.link_ack = false;
  buffered.awaited = kNoSeq;
  buffered.size_bytes = static_cast<std::uint8_t>(frame.payload.size());
  std::copy_n(frame.payload.data(), frame.payload.size(), buffered.payload.begin());
  node.state.waiting.push() = frame.link;
  node.actions.followed("N2-IN-ORDER"_rule);
}

template <std::size_t kRoom>
void handle_first(Node& node, Interface<kRoom>& line, Link link) {
  const Buffered& first = line.in.front();
  handle(node, {link, first.dest, first.src, first.type, first.bytes()});
  line.in.pop();
}

}  // namespace

void hear(Node& node, const Frame& frame) {
  //= N11-NEXT: After a malformed message the next good one is handled as always.
  if (!frame.packet.empty()) return node.actions.ignored("N11-NEXT"_rule);
  if (!is_for_us(node, frame)) return;
  if (!is_known_type(node.config().role, frame.link, frame.type)) {
    return node.actions.ignored(ReqId::kNone);
  }
  if (frame.payload.size() > kAmPayloadMax) return node.actions.ignored("WIRE-AM-LENGTH"_rule);
  if (!node.state.app_busy || frame.link == Link::kPeis) return handle(node, frame);
  if (frame.link == Link::kRadio) return wait(node, node.state.radio, frame);
  wait(node, node.state.serial, frame);
}

void handle_waiting(Node& node) {
  State& state = node.state;
  while (!state.waiting.empty()) {
    const Link link = state.waiting.front();
    state.waiting.pop();
    //= N2-IN-ORDER: Messages that arrived while the application was busy are handled in the order
    //= of their arrival, each once.
    node.actions.followed("N2-IN-ORDER"_rule);
    if (link == Link::kRadio) {
      handle_first(node, state.radio, link);
    } else {
      handle_first(node, state.serial, link);
    }
  }
}

}  // namespace rubric::machine
