#include "conformance/adapters/cpp/node.h"

#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"
#include "codec/generated/rubicon/synaptic_data.h"

namespace rubric::cpp_node {
namespace {

constexpr std::size_t kDataMax = 100;
constexpr std::size_t kAwaitedMax = 8;
constexpr Ticks kAckTimeout = 1000;
// Messages that fit into the buffers of a line, outgoing and incoming alike.
constexpr std::size_t kRadioRoom = 4;
constexpr std::size_t kSerialRoom = 2;
constexpr std::size_t kPeisRoom = 16;
constexpr std::size_t kRoom[] = {kRadioRoom, kSerialRoom, kPeisRoom};

bool is_application(Component component) {
  return component == Component::kMockup || component == Component::kLearning ||
         component == Component::kControlLayer;
}

bool is_broadcast(Address address) { return address.island == kAll || address.device == kAll; }

}  // namespace

Node::Node(const Settings& settings, Ticks phase, World& world)
    : world_(world),
      now_(settings.now),
      started_(settings.now),
      next_number_(settings.next_number),
      lines_{out_line(Line::kRadio), out_line(Line::kSerial), out_line(Line::kPeis)},
      synaptic_(settings.channels, phase, world,
                [this](Address dest, const Values& values) { return send_values(dest, values); }) {}

OutLine Node::out_line(Line which) {
  return {which, kRoom[static_cast<std::size_t>(which)], [this](Line line, const Frame& frame) {
            left(line, frame);
            world_.transmit(line, frame);
          }};
}

std::optional<Ticks> Node::due() const {
  std::optional<Ticks> soonest = synaptic_.next_tick();
  for (const Awaited& one : awaited_) {
    soonest = std::min(soonest.value_or(one.deadline), one.deadline);
  }
  return soonest;
}

void Node::run_due() {
  //= T3-TIMEOUT: A reliable message without its ack is signalled as receive_ack(failure) when its
  //= timeout expires, not before.
  while (!awaited_.empty() && awaited_.front().deadline <= now_) {
    const Awaited late = awaited_.front();
    awaited_.erase(awaited_.begin());
    world_.ack_received(late.application, late.number, false);
  }
  if (synaptic_.next_tick() && *synaptic_.next_tick() <= now_ && address()) {
    synaptic_.tick(*address());
  }
}

void Node::heard(Line from, const Frame& frame) {
  if (!line(from).is_on() || !is_for_me(from, frame)) return;
  const Bytes payload(frame.payload.data(), frame.payload.size());
  if (frame.type != AmType::kNet) {
    control(from, frame);
  } else if (const auto net = read_message(payload); net && !application_busy_) {
    message(from, *net);
  } else if (net) {
    //= N2-IN-FULL: A message that finds the incoming buffer full is dropped; those queued before it
    //= are neither changed nor lost, and later messages are handled.
    const auto same_line = std::count_if(waiting_.begin(), waiting_.end(),
                                         [&](const Waiting& one) { return one.line == from; });
    if (static_cast<std::size_t>(same_line) < kRoom[static_cast<std::size_t>(from)]) {
      waiting_.push_back({from, *net});
    }
  }
  may_have_room();
}

void Node::set_busy(Line which, bool busy) {
  line(which).set_busy(busy);
  may_have_room();
}

void Node::set_application_busy(bool busy) {
  application_busy_ = busy;
  while (!application_busy_ && !waiting_.empty()) {
    const Waiting next = waiting_.front();
    waiting_.pop_front();
    message(next.line, next.message);
  }
  may_have_room();
}

void Node::confirmed(bool) {
  line(Line::kRadio).confirmed();
  may_have_room();
}

void Node::join(const MoteDesc&) { world_.joined(address().value_or(Address{}), false); }

bool Node::is_awaited(std::uint16_t number) const {
  return std::any_of(awaited_.begin(), awaited_.end(),
                     [&](const Awaited& one) { return one.number == number; });
}

//= N12-REUSE: A sequence number is not used again while its ack is awaited.
std::uint16_t Node::take_number() {
  while (next_number_ == kNoNumber || is_awaited(next_number_)) ++next_number_;
  return next_number_++;
}

std::uint16_t Node::send(Address dest, Component application, bool reliable, Bytes data) {
  if (!address() || data.size() > kDataMax) return kNoNumber;
  if (reliable && awaited_.size() >= kAwaitedMax) return kNoNumber;
  //= N3-LOCAL: dest.pid 0xFFFE (local island) is replaced by the sender's own island before the
  //= message is sent.
  if (dest.island == kLocal) dest.island = address()->island;
  if (dest.device == kLocal) dest.device = address()->device;
  if (dest == *address()) return kNoNumber;
  const Message message{dest,
                        *address(),
                        reliable,
                        take_number(),
                        Component::kConnless,
                        application,
                        Data(data.begin(), data.end())};
  if (!route(message)) return kNoNumber;
  if (reliable) awaited_.push_back({message.number, dest, application, now_ + kAckTimeout});
  return message.number;
}

bool Node::set_interface(Line which, bool on) {
  if (!interface(which)) return false;
  line(which).set_on(on);
  may_have_room();
  return true;
}

std::optional<bool> Node::interface(Line which) const {
  if (which == Line::kPeis) return {};
  return lines_[static_cast<std::size_t>(which)].is_on();
}

std::uint32_t Node::clock_ms() const {
  return static_cast<std::uint32_t>((now_ - started_) * 1000 / 1024);
}

std::optional<ChannelId> Node::create(Direction direction, Address peer, std::size_t size,
                                      Mode mode) {
  if (!address()) return {};
  return synaptic_.create(direction, *address(), peer, size, mode);
}

void Node::deliver(const Message& message) {
  const Bytes body(message.body.data(), message.body.size());
  if (message.transport == Component::kConnless && is_application(message.application)) {
    //= T2-ACK: A reliable Connectionless message to the node itself, with an APPID that it knows,
    //= is answered by an ack.
    if (message.reliable && !is_broadcast(message.dest)) acknowledge(message);
    world_.received(message.src, message.application, body);
  } else if (message.transport == Component::kRubiconAck) {
    settle(message);
  } else if (message.transport == Component::kSynChannel) {
    using On = rubicon::SynapticDataLayout::ValuesAt;
    Values values;
    for (std::size_t i = 0; (i + 1) * On::kUnitBytes <= body.size(); ++i) {
      values.push_back(On::load(body.data(), i));
    }
    synaptic_.take(*address(), message.src, values);
  }
}

void Node::acknowledge(const Message& message) {
  if (message.src == *address() || is_broadcast(message.src)) return;
  rubicon::RubiconAck ack;
  ack.type = AmType::kLearningNotification;
  ack.seq_num = message.number;
  route({message.src, *address(), false, take_number(), Component::kRubiconAck, message.application,
         bytes_of(ack)});
}

void Node::settle(const Message& ack) {
  const Bytes body(ack.body.data(), ack.body.size());
  const auto with_code = rubicon::RubiconAckView::parse(body);
  const auto bare = rubicon::RubiconAckSeqOnlyView::parse(body);
  if (!bare) return;
  const bool has_code = with_code && with_code->type() == AmType::kLearningNotification;
  const std::uint16_t number = has_code ? with_code->seq_num() : bare->seq_num();
  //= T3-SENDER: An ack counts only if it comes from the message's destination and carries its
  //= APPID.
  const auto found = std::find_if(awaited_.begin(), awaited_.end(), [&](const Awaited& one) {
    return one.number == number && one.dest == ack.src && one.application == ack.application;
  });
  if (found == awaited_.end()) return;
  awaited_.erase(found);
  world_.ack_received(ack.application, number, !has_code || with_code->ack() == 0);
}

bool Node::send_values(Address dest, const Values& values) {
  rubicon::SynapticData data;
  for (const float value : values) data.values.push(value);
  return route({dest, *address(), false, take_number(), Component::kSynChannel, Component::kEsnData,
                bytes_of(data)});
}

}  // namespace rubric::cpp_node
