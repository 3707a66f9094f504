#include "conformance/adapters/cpp/mote.h"

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"

namespace rubric::cpp_node {
namespace {

constexpr int kRequests = 5;
constexpr int kAckJoins = 5;
constexpr Ticks kJoinPeriod = 500;
constexpr Ticks kPhase = 30;  // Between the synaptic clocks of neighbouring devices.

}  // namespace

Mote::Mote(const Settings& settings, World& world)
    : Node(settings, settings.device > 0 ? (settings.device - 1u) * kPhase : 0, world),
      device_(settings.device) {}

std::optional<Ticks> Mote::due() const {
  const auto other = Node::due();
  return timer_ && (!other || *timer_ < *other) ? timer_ : other;
}

void Mote::run_due() {
  Node::run_due();
  if (!timer_ || *timer_ > now()) return;
  if (requests_left_ > 0) return request();
  timer_.reset();
  line(Line::kRadio).drop(AmType::kJoin);
  world().joined({}, false);
}

void Mote::join(const MoteDesc& description) {
  //= J8-JOINED: joinIsland of a mote that is joined fails at once and sends nothing.
  if (address_ || timer_) return world().joined(address_.value_or(Address{}), false);
  description_ = description;
  number_ = take_number();
  requests_left_ = kRequests;
  asked_ = false;
  request();
}

void Mote::request() {
  --requests_left_;
  timer_ = now() + kJoinPeriod;
  if (line(Line::kRadio).holds(AmType::kJoin)) return;  // The one before is yet to leave.
  rubicon::JoinRequest request;
  request.seq_num = number_;
  request.mote_desc = description_;
  line(Line::kRadio).push({kSinkDevice, device_, AmType::kJoin, bytes_of(request)});
}

//= J8-PERIOD: A join_request follows the one before it no earlier than the join timeout.
void Mote::left(Line, const Frame& frame) {
  if (frame.type != AmType::kJoin || !timer_) return;
  timer_ = now() + kJoinPeriod;
  asked_ = true;
}

bool Mote::is_for_me(Line line, const Frame& frame) const {
  return line == Line::kRadio && (frame.dest == device_ || frame.dest == kAll);
}

void Mote::control(Line, const Frame& frame) {
  if (frame.type != AmType::kJoinReply) return;
  const auto reply =
      rubicon::JoinReplyView::parse(Bytes(frame.payload.data(), frame.payload.size()));
  //= J4-JOINED: A mote that is joined, or has no request outstanding, ignores a join_reply.
  if (!reply || !timer_ || !asked_) return;
  //= J4-SEQ: A mote ignores a join_reply whose sequence number is not that of its outstanding
  //= request.
  if (reply->seq_num() != number_) return;
  if (reply->mote_addr() != device_ || is_reserved(reply->island_addr())) return;
  timer_.reset();
  //= J5-STOP: A mote that is joined sends no further join_request.
  line(Line::kRadio).drop(AmType::kJoin);
  address_ = Address{reply->island_addr(), device_};
  sink_ = frame.src;
  accepted_at_ = now();
  clock_at_acceptance_ms_ = reply->cur_time();
  ack_joins_left_ = kAckJoins;
  send_ack_join();
  world().joined(*address_, true);
}

void Mote::send_ack_join() {
  --ack_joins_left_;
  rubicon::AckJoin ack;
  ack.dest = wire_of({address_->island, sink_});
  ack.src = wire_of(*address_);
  ack.seq_num = number_;
  ack.mote_desc = description_;
  line(Line::kRadio).push({sink_, device_, AmType::kAckJoin, bytes_of(ack), true});
}

void Mote::confirmed(bool acked) {
  Node::confirmed(acked);
  const bool in_time = now() < accepted_at_ + kJoinPeriod && line(Line::kRadio).is_free();
  if (acked) ack_joins_left_ = 0;
  if (address_ && ack_joins_left_ > 0 && in_time) send_ack_join();
}

std::uint32_t Mote::clock_ms() const {
  if (!address_) return Node::clock_ms();
  return clock_at_acceptance_ms_ + static_cast<std::uint32_t>((now() - accepted_at_) * 1000 / 1024);
}

bool Mote::route(const Message& message) {
  std::uint16_t next = sink_;
  if (message.dest.island == kAll) next = kAll;
  //= N4-SINK: A mote sends a net_msg for another island, or with devid NULL, to the AM address of
  //= its sink.
  const bool in_island = message.dest.island == address_->island && message.dest.device != kNull;
  if (in_island) next = message.dest.device;
  return line(Line::kRadio).push({next, device_, AmType::kNet, write_message(message)});
}

void Mote::message(Line, const Message& message) {
  //= J11-HEAR: A mote that is not a member ignores the net_msg that it hears.
  if (!address_) return;
  const Address dest = message.dest;
  const bool island = dest.island == address_->island || dest.island == kAll;
  if (island && (dest.device == device_ || dest.device == kAll)) deliver(message);
}

}  // namespace rubric::cpp_node
