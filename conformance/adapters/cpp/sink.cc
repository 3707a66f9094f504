#include "conformance/adapters/cpp/sink.h"

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/serial_joined.h"

namespace rubric::cpp_node {
namespace {

constexpr std::size_t kMembersMax = 20;
constexpr std::size_t kOpenJoinsMax = 20;

Bytes payload_of(const Frame& frame) { return Bytes(frame.payload.data(), frame.payload.size()); }

}  // namespace

Sink::Sink(const Settings& settings, World& world)
    : Node(settings, 0, world), address_{settings.island, settings.device} {}

bool Sink::is_for_me(Line line, const Frame& frame) const {
  if (line == Line::kSerial) return true;  // It has two ends only; mostly it has 0 and 0.
  return line == Line::kRadio && (frame.dest == address_.device || frame.dest == kAll);
}

void Sink::control(Line line, const Frame& frame) {
  if (line == Line::kSerial && frame.type == AmType::kConfig) configure(frame);
  if (line == Line::kRadio && frame.type == AmType::kJoin) join_request(frame);
  if (line == Line::kRadio && frame.type == AmType::kAckJoin) ack_join(frame);
}

bool Sink::is_member(std::uint16_t device) const {
  return std::any_of(members_.begin(), members_.end(),
                     [&](const Mote& one) { return one.device == device; });
}

void Sink::join_request(const Frame& frame) {
  const auto request = rubicon::JoinRequestView::parse(payload_of(frame));
  if (!request || is_reserved(frame.src) || frame.src == address_.device) return;
  //= J2-LISTED: A sink ignores a join_request of a mote that is already in its list.
  if (is_member(frame.src) || members_.size() >= kMembersMax) return;
  //= J9-INTERLEAVE: Joins of several motes may interleave at a sink; each keeps its own sequence
  //= number and descriptor.
  std::erase_if(open_joins_, [&](const Mote& one) { return one.device == frame.src; });
  if (open_joins_.size() >= kOpenJoinsMax) open_joins_.pop_front();
  open_joins_.push_back({frame.src, request->seq_num(), request->mote_desc().to_value()});
  rubicon::JoinReply reply;
  reply.island_addr = address_.island;
  reply.mote_addr = frame.src;
  reply.cur_time = clock_ms();
  reply.seq_num = request->seq_num();
  line(Line::kRadio).push({frame.src, address_.device, AmType::kJoinReply, bytes_of(reply)});
}

void Sink::ack_join(const Frame& frame) {
  const auto ack = rubicon::AckJoinView::parse(payload_of(frame));
  if (!ack || address_of(ack->dest()) != address_) return;
  if (address_of(ack->src()) != Address{address_.island, frame.src}) return;
  const auto open = std::find_if(open_joins_.begin(), open_joins_.end(), [&](const Mote& one) {
    return one.device == frame.src && one.number == ack->seq_num();
  });
  if (open == open_joins_.end() || members_.size() >= kMembersMax) return;
  members_.push_back(*open);
  open_joins_.erase(open);
  world().mote_joined(address_of(ack->src()), members_.back().description);
}

//= J6-REPORT: A sink reports each new member to its base station with one serial_joined.
void Sink::may_have_room() {
  for (Mote& member : members_) {
    if (member.reported || !line(Line::kSerial).has_room()) continue;
    rubicon::SerialJoined report;
    report.msg_type = AmType::kSerialJoined;
    report.island_addr = address_.island;
    report.mote_addr = member.device;
    report.mote_type = member.description.mote_type;
    report.transducers = member.description.transducers;
    report.actuators = member.description.actuators;
    member.reported = true;
    hand_up({{address_.island, kNull},
             {address_.island, member.device},
             false,
             take_number(),
             Component::kConnless,
             Component::kControlLayer,
             bytes_of(report)});
  }
}

void Sink::configure(const Frame& frame) {
  const auto config = rubicon::ConfigView::parse(payload_of(frame));
  if (!config || config->type() != rubicon::CommandCode::kSetIslandId) return;
  if (is_reserved(config->value()) || config->value() == address_.island) return;
  address_.island = config->value();
  //= N9-MEMBERS: A sink whose island id changes forgets its members.
  members_.clear();
  open_joins_.clear();
  line(Line::kRadio).drop(AmType::kJoinReply);  // It offers the island that is no more.
}

bool Sink::radiate(const Message& message) {
  const std::uint16_t next = message.dest.island == kAll ? kAll : message.dest.device;
  return line(Line::kRadio).push({next, address_.device, AmType::kNet, write_message(message)});
}

// Like release 1.0: to everybody, from nobody, and as long as a message can be.
bool Sink::hand_up(const Message& message) {
  return line(Line::kSerial).push({kAll, 0, AmType::kNet, write_message(message, true)});
}

bool Sink::route(const Message& message) {
  const Address dest = message.dest;
  if (dest.island == kAll) return radiate(message);
  //= N6-OWN: What a sink itself sends to <its island, NULL> or to another island goes over serial.
  if (dest.island != address_.island || dest.device == kNull) return hand_up(message);
  return radiate(message);
}

void Sink::message(Line line, const Message& message) {
  if (line == Line::kRadio) from_radio(message);
  if (line == Line::kSerial) from_serial(message);
}

void Sink::from_radio(const Message& message) {
  const Address dest = message.dest;
  if (dest.island == address_.island || dest.island == kAll) {
    if (dest.device == address_.device || dest.device == kAll) return deliver(message);
    if (dest == Address{address_.island, kNull}) hand_up(message);
  } else if (message.src.island == address_.island) {
    //= N6-ROUTE: A sink forwards a net_msg from the radio whose dest.pid is foreign and whose
    //= src.pid is its own island to its base station over serial.
    hand_up(message);
  }
}

void Sink::from_serial(const Message& message) {
  const Address dest = message.dest;
  const bool every_island = dest.island == kAll;
  //= N7-FOREIGN: A sink does not send a net_msg from serial for another island on the radio.
  if (dest.island != address_.island && !every_island) return;
  if (dest.device == address_.device || dest.device == kAll) deliver(message);
  if (dest.device != address_.device && dest.device != kNull) radiate(message);
}

}  // namespace rubric::cpp_node
