// The join protocol, a mote's side and a sink's. (paper: Component Management)
#pragma once

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/node/node.h"
#include "conformance/node/wire.h"

namespace rubric {
namespace node {

inline void Node::join(const Descriptor& descriptor) {
  //= J8-JOINED: joinIsland of a mote that is joined fails at once and sends nothing.
  //= J5-ONCE: Each joinIsland call ends in exactly one joined event, SUCCESS or FAIL.
  // A call while another runs ends here and does not disturb it.
  const bool may = role_ == Role::kMote && join_.phase == Phase::kOutside;
  if (!may) return application_.joined(address(), false);
  const uint16_t before = join_.seq_num;
  const bool again = join_.requests != 0;
  join_ = Join();
  join_.phase = Phase::kJoining;
  join_.descriptor = descriptor;
  //= J1-SEQ: A new joinIsland call uses a sequence number other than the one of the call before it.
  do {
    join_.seq_num = awaiting_.next_seq_num();
  } while (again && join_.seq_num == before);
  join_.requests = 1;
  join_.due = now_ + kJoinPeriodTicks + slack_;
  send_join_request();
}

inline void Node::send_join_request() {
  // While the one before waits for the radio it covers this one, too.
  if (is_waiting(kAmJoin)) return;
  Message* const message = take_place(Line::kRadio);
  if (message == nullptr) return;
  //= J1-REQUEST: joinIsland sends a join_request that carries the descriptor of the call.
  rubicon::JoinRequest request;
  request.seq_num = join_.seq_num;
  request.mote_desc = join_.descriptor;
  rubicon::JoinRequestLayout::store(request, message->room());
  //= J1-DEST: A join_request is sent to the AM address of the sink, 1.
  send_message(Line::kRadio, *message, kSinkId, kAmJoin, rubicon::JoinRequestView::kMaxSizeBytes);
}

inline void Node::join_timer_due() {
  //= J8-LIMIT: A joinIsland call sends at most five join_requests.
  if (join_.requests < kJoinRequestsMax) {
    ++join_.requests;
    join_.due = now_ + kJoinPeriodTicks + slack_;
    //= J8-RETRY: When the join timer expires before success and requests remain, the mote sends the
    //= join_request again.
    return send_join_request();
  }
  join_.phase = Phase::kOutside;
  forget_waiting(kAmJoin);
  application_.joined(address(), false);
}

inline void Node::hear_join_reply(uint16_t src, Bytes payload) {
  //= J10-SINK: A sink ignores join_reply.
  if (role_ != Role::kMote) return;
  const auto reply = rubicon::JoinReplyView::parse(payload);
  //= J4-JOINED: A mote that is joined, or has no request outstanding, ignores a join_reply.
  if (!reply || join_.phase != Phase::kJoining) return;
  //= J4-ADDRESS: A mote ignores a join_reply whose mote_addr is not its own TinyOS id or whose
  //= island_addr is reserved.
  if (reply->mote_addr() != id_ || is_reserved(reply->island_addr())) return;
  //= J4-SEQ: A mote ignores a join_reply whose sequence number is not that of its outstanding
  //= request.
  if (reply->seq_num() != join_.seq_num) return;
  join_.phase = Phase::kMember;
  join_.island = reply->island_addr();
  join_.sink = src;
  join_.acks = 1;
  join_.accepted = now_;
  //= J4-CLOCK: A mote that accepts a join_reply sets its clock to cur_time.
  clock_offset_ms_ = reply->cur_time() - time_ms();
  //= J5-STOP: A mote that is joined sends no further join_request.
  forget_waiting(kAmJoin);
  send_ack_join();
  application_.joined(address(), true);
}

inline void Node::send_ack_join() {
  //= J4-CONTENT: ack_join has dest <island, sink> of the accepted reply, src the new address, the
  //= request's sequence number and the descriptor of the request, and goes to the sink's AM
  //= address.
  rubicon::AckJoin ack;
  ack.dest = wire_of({join_.island, join_.sink});
  ack.src = wire_of(address());
  ack.seq_num = join_.seq_num;
  ack.mote_desc = join_.descriptor;
  constexpr size_t kBytes = rubicon::AckJoinView::kMaxSizeBytes;
  if (join_.acks > 1 && at(Line::kRadio).on &&
      !at(Line::kRadio).busy) {  // A repeat goes before what came later.
    Message repeat;
    rubicon::AckJoinLayout::store(ack, repeat.room());
    repeat.set_header(join_.sink, id_, kAmAckJoin, kBytes);
    at(Line::kRadio).sending = sending_ack_join_ = true;
    return driver_.transmit(Line::kRadio, repeat.packet(), true);
  }
  Message* const message = take_place(Line::kRadio);
  if (message == nullptr) return;
  rubicon::AckJoinLayout::store(ack, message->room());
  send_message(Line::kRadio, *message, join_.sink, kAmAckJoin, kBytes);
}

inline bool Node::ack_join_is_late() const { return now_ - join_.accepted >= kJoinPeriodTicks; }

inline void Node::ack_join_left(bool acked) {
  if (join_.phase != Phase::kMember || join_.acked) return;
  join_.acked = acked;
  //= J4-FEW: An ack_join is repeated at most five times.
  //= J4-REPEAT: The ack_join of an accepted reply is repeated only unchanged, within one join
  //= period of the last request or of the acceptance, and at most 20 times.
  if (acked || join_.acks >= kAckJoinsMax || ack_join_is_late()) return;
  ++join_.acks;
  send_ack_join();
}

inline void Node::hear_join_request(uint16_t src, Bytes payload) {
  //= J10-MOTE: A mote ignores join_request and ack_join.
  if (!is_sink()) return;
  const auto request = rubicon::JoinRequestView::parse(payload);
  // No mote has such a TinyOS id, so no reply could name it. (decision 132)
  if (!request || is_reserved(src) || src == id_) return;
  const Descriptor descriptor = request->mote_desc().to_value();
  if (!admissions_.request(src, request->seq_num(), descriptor)) return;
  Message* const message = take_place(Line::kRadio);
  if (message == nullptr) return;
  //= J3-SEQ: A join_reply carries the sequence number of the request that it answers.
  //= J3-ADDRESS: A join_reply carries the sink's island id as island_addr and the requesting mote's
  //= TinyOS id as mote_addr.
  rubicon::JoinReply reply;  // Its cur_time is set when it leaves.
  reply.island_addr = island_;
  reply.mote_addr = src;
  reply.seq_num = request->seq_num();
  rubicon::JoinReplyLayout::store(reply, message->room());
  //= J3-DEST: A join_reply is sent to the AM address that asked.
  send_message(Line::kRadio, *message, src, kAmJoinReply, rubicon::JoinReplyView::kMaxSizeBytes);
}

inline void Node::hear_ack_join(uint16_t src, Bytes payload) {
  if (!is_sink()) return;
  const auto ack = rubicon::AckJoinView::parse(payload);
  if (!ack) return;
  const Address from = address_of(ack->src());
  //= J6-ISLAND: A sink ignores an ack_join whose dest.pid is not its island.
  //= J6-SENDER: A sink ignores an ack_join whose dest.devid is not its own, or whose src is not
  //= <dest.pid, the AM source>.
  if (address_of(ack->dest()) != address() || from != Address{island_, src}) return;
  const Admission* const member = admissions_.acknowledge(src, ack->seq_num());
  if (member == nullptr) return;
  //= J6-ONLY: A sink adds a mote to its list, announces and reports it only on an ack_join.
  application_.mote_joined(from, member->descriptor);
  report_members();
}

inline void Node::report_members() {
  if (!is_sink()) return;
  //= J6-REPORT: A sink reports each new member to its base station with one serial_joined.
  // Nothing would repeat it, so it waits until the line has room.
  while (Admission* const member = admissions_.owed()) {
    Message* const message = take_place(Line::kSerial);
    if (message == nullptr) return;
    member->state = Admission::State::kMember;
    uint8_t* const body = message->room() + kNetHeaderBytes;
    //= J6-CONTENT: serial_joined carries the member's address and descriptor in an unreliable
    //= net_msg from <island, mote> to <island, NULL>, TRANSID CONNLESS, APPID CONTROL_LAYER.
    rubicon::AppMsgLayout::TransIdAt::store(body, rubicon::Component::kConnless);
    rubicon::AppMsgLayout::AppIdAt::store(body, rubicon::Component::kControlLayer);
    rubicon::SerialJoined joined;
    joined.msg_type = rubicon::AmType::kSerialJoined;
    joined.island_addr = island_;
    joined.mote_addr = member->devid;
    joined.mote_type = member->descriptor.mote_type;
    joined.transducers = member->descriptor.transducers;
    joined.actuators = member->descriptor.actuators;
    rubicon::SerialJoinedLayout::store(joined, body + kAppHeaderBytes);
    rubicon::NetMsg wire;
    wire.dest = wire_of({island_, kNullDevid});
    wire.src = wire_of({island_, member->devid});
    wire.payload = Bytes(body, kAppHeaderBytes + rubicon::SerialJoinedView::kMaxSizeBytes);
    rubicon::NetMsgLayout::store(wire, message->room());
    send_net_msg(Line::kSerial, *message, kBroadcast, kNetHeaderBytes + wire.payload.size());
  }
}

inline void Node::hear_config(Bytes payload) {
  const auto config = rubicon::ConfigView::parse(payload);
  //= N9-OTHER: A config message of another type, or with a reserved island id, changes nothing, and
  //= a base station sets no such id.
  if (!config || config->type() != rubicon::CommandCode::kSetIslandId) return;
  if (is_reserved(config->value()) || config->value() == island_) return;
  //= N9-SET: A config message SET_ISLAND_ID over serial sets the sink's island id, and a base
  //= station sends it when its own is set; from then on both use the new id.
  island_ = config->value();
  //= N9-MEMBERS: A sink whose island id changes forgets its members.
  admissions_.clear();
  forget_waiting(kAmJoinReply);  // They offer the island that is no more.
}

}  // namespace node
}  // namespace rubric
