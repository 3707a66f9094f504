// The outgoing half of both lines. (paper: The Network level)
#pragma once

#include "codec/generated/rubicon/join_reply.h"
#include "conformance/node/node.h"
#include "conformance/node/wire.h"

namespace rubric {
namespace node {

// Returns a place in the line's buffer, or null. It is to be filled and sent at once.
inline Message* Node::take_place(Line line) {
  LineState& state = at(line);
  //= N10-OFF: An interface that is switched off sends nothing and receives nothing.
  if (!state.on || state.out().full()) return nullptr;
  return &state.out().push();
}

inline void Node::send_message(Line line, Message& message, uint16_t dest, uint8_t type,
                               size_t bytes) {
  constexpr uint16_t kNobody = 0;  // A serial line has two ends only.
  const uint16_t src[kLines] = {id_, kNobody, island_};
  message.set_header(dest, src[static_cast<uint8_t>(line)], type, bytes);
  flush(line);
}

// Sends a net_msg; on the serial line it always has its full length.
inline void Node::send_net_msg(Line line, Message& message, uint16_t dest, size_t bytes) {
  if (line == Line::kSerial) {
    memset(message.room() + bytes, 0, kAmPayloadMax - bytes);
    bytes = kAmPayloadMax;
  }
  send_message(line, message, dest, kAmNet, bytes);
}

inline void Node::flush(Line line) {
  LineState& state = at(line);
  if (state.flushing) return;
  state.flushing = true;
  //= N2-BUSY: While a line is busy nothing is sent on it.
  while (state.on && !state.sending && !state.busy && !state.out().empty()) {
    //= N2-ORDER: Messages leave each line in the order in which they were accepted for it.
    Message& message = state.out().front();
    const bool ack_join = line == Line::kRadio && message.type() == kAmAckJoin;
    const bool late = ack_join && join_.acks > 1 && ack_join_is_late();
    // The radio's chip takes a copy; on the other lines the message stays until it is sent.
    if (line == Line::kRadio) state.out().pop();
    if (late) continue;
    leave(message);
    state.sending = true;
    if (line == Line::kRadio) sending_ack_join_ = ack_join;
    driver_.transmit(line, message.packet(), ack_join);
  }
  state.flushing = false;
}

// Starts the times that count from when the line has the message.
inline void Node::leave(Message& message) {
  if (message.type() == kAmJoinReply) {
    const MutableBytes payload(message.room(), kAmPayloadMax);
    const auto reply = rubicon::JoinReplyBuilder::create(payload);
    //= J3-TIME: cur_time of a join_reply is the sink's clock in ms when it replies; it does not
    //= stand still for a second or more between replies.
    rubicon::JoinReplyBuilder(*reply).set_cur_time(clock_ms());
  }
  //= J8-PERIOD: A join_request follows the one before it no earlier than the join timeout.
  if (message.type() == kAmJoin) join_.due = now_ + kJoinPeriodTicks + slack_;
  if (message.type() != kAmNet) return;
  const auto view = rubicon::NetMsgView::parse(message.payload());
  // Its island may have become another one since it waits.
  if (view && address_of(view->src()).devid == address().devid)
    awaiting_.left(view->seq_num(), now_ + kAckTimeoutTicks + slack_);
}

inline void Node::forget_waiting(uint8_t type) {
  for (uint8_t i = at(Line::kRadio).out().size(); i-- > 0;) {
    if (at(Line::kRadio).out()[i].type() == type) at(Line::kRadio).out().erase(i);
  }
}

inline bool Node::is_waiting(uint8_t type) {
  for (uint8_t i = 0; i < at(Line::kRadio).out().size(); ++i) {
    if (at(Line::kRadio).out()[i].type() == type) return true;
  }
  return false;
}

inline void Node::sent(Line line, bool acked) {
  LineState& state = at(line);
  if (!state.sending) return;
  state.sending = false;
  if (line != Line::kRadio) {
    state.out().pop();
  } else if (sending_ack_join_) {
    sending_ack_join_ = false;
    ack_join_left(acked);
  }
  flush(line);
  report_members();
}

inline void Node::set_busy(Line line, bool busy) {
  at(line).busy = busy;
  flush(line);
}

}  // namespace node
}  // namespace rubric
