// The outgoing half of both lines. (paper: The Network level)
#include "codec/generated/rubicon/join_reply.h"
#include "conformance/adapters/firmware/node/node.h"
#include "conformance/adapters/firmware/node/wire.h"

namespace rubric {
namespace firmware {

// Returns a place in the line's buffer, or null. It is to be filled and sent at once.
Message* Node::take_place(Line line) {
  LineState& state = line_of(line);
  //= N10-OFF: An interface that is switched off sends nothing and receives nothing.
  if (!state.on || state.out.full()) return nullptr;
  return &state.out.push();
}

void Node::send_message(Line line, Message& message, uint16_t dest, uint8_t type, size_t bytes) {
  message.set_header(dest, line == Line::kRadio ? id_ : uint16_t{0}, type, bytes);
  flush(line);
}

// Sends a net_msg; on the serial line it always has its full length.
void Node::send_net_msg(Line line, Message& message, uint16_t dest, size_t bytes) {
  if (line == Line::kSerial) {
    memset(message.room() + bytes, 0, kAmPayloadMax - bytes);
    bytes = kAmPayloadMax;
  }
  send_message(line, message, dest, kAmNet, bytes);
}

void Node::flush(Line line) {
  if (line == Line::kRadio) return flush_radio();
  flush_serial();
}

void Node::flush_radio() {
  //= N2-BUSY: While a line is busy nothing is sent on it.
  while (radio_.on && !radio_.sending && !radio_.busy && !radio_.out.empty()) {
    //= N2-ORDER: Messages leave each line in the order in which they were accepted for it.
    Message& message = radio_.out.front();
    const uint8_t type = message.type();
    const bool late = type == kAmAckJoin && join_.acks > 1 && ack_join_is_late();
    if (!late) {
      leave(message);
      radio_.sending = true;
      sending_ack_join_ = type == kAmAckJoin;
      radio_port_.send(message.dest(), type, message.payload(), type == kAmAckJoin);
    }
    radio_.out.pop();  // The chip has a copy.
  }
}

void Node::flush_serial() {
  if (!serial_.on || serial_.sending || serial_.busy || serial_.out.empty()) return;
  Message& message = serial_.out.front();  // It stays until it is sent.
  leave(message);
  serial_.sending = true;
  serial_port_.send(message.packet());
}

// Starts the times that count from when the line has the message.
void Node::leave(Message& message) {
  const Ticks now = clock_.now();
  if (message.type() == kAmJoinReply) {
    const MutableBytes payload(message.room(), kAmPayloadMax);
    const auto reply = rubicon::JoinReplyBuilder::create(payload);
    //= J3-TIME: cur_time of a join_reply is the sink's clock in ms when it replies; it does not
    //= stand still for a second or more between replies.
    rubicon::JoinReplyBuilder(*reply).set_cur_time(clock_ms());
  }
  //= J8-PERIOD: A join_request follows the one before it no earlier than the join timeout.
  if (message.type() == kAmJoin) join_.due = now + kJoinPeriodTicks + 1;
  if (message.type() != kAmNet) return;
  const auto view = rubicon::NetMsgView::parse(message.payload());
  if (view && address_of(view->src()) == address()) awaiting_.left(view->seq_num(), now);
}

void Node::forget_waiting(uint8_t type) {
  for (uint8_t i = radio_.out.size(); i-- > 0;) {
    if (radio_.out[i].type() == type) radio_.out.erase(i);
  }
}

bool Node::is_waiting(uint8_t type) {
  for (uint8_t i = 0; i < radio_.out.size(); ++i) {
    if (radio_.out[i].type() == type) return true;
  }
  return false;
}

void Node::radio_sent(bool acked) {
  if (!radio_.sending) return;
  radio_.sending = false;
  if (sending_ack_join_) {
    sending_ack_join_ = false;
    ack_join_left(acked);
  }
  flush_radio();
}

void Node::serial_sent() {
  if (!serial_.sending) return;
  serial_.sending = false;
  serial_.out.pop();
  flush_serial();
  report_members();
}

void Node::set_line_busy(Line line, bool busy) {
  line_of(line).busy = busy;
  flush(line);
}

}  // namespace firmware
}  // namespace rubric
