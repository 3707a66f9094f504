#include "tools/commands/run/own_layer.h"

#include "conformance/machine/messages.h"

namespace rubric::run {
namespace {

machine::Address address_of(node::Address address) { return {address.pid, address.devid}; }

machine::Descriptor descriptor_of(const node::Descriptor& descriptor) {
  machine::Descriptor out;
  out.mote_type = static_cast<std::uint8_t>(descriptor.mote_type);
  out.actuators = descriptor.actuators.raw();
  out.transducers = descriptor.transducers.raw();
  return out;
}

node::Address wire_address(machine::Address address) { return {address.pid, address.devid}; }

// Makes calls of an application at the node. Returns the result of each; nothing for joinIsland,
// which ends in Joined.
class Performer {
 public:
  explicit Performer(node::Node& node) : node_(node) {}

  std::optional<machine::Notice> operator()(const machine::JoinIsland& call) const {
    node_.join(machine::wire_of(call.descriptor));
    return std::nullopt;
  }
  std::optional<machine::Notice> operator()(const machine::Send& call) const {
    return machine::SendResult{
        node_.send(wire_address(call.dest), call.app_id, call.reliable, call.data)};
  }
  std::optional<machine::Notice> operator()(const machine::SetInterface& call) const {
    return result(node_.set_interface(line_of(call.link), call.on));
  }
  std::optional<machine::Notice> operator()(const machine::GetInterface& call) const {
    if (call.link == machine::Link::kPeis) return result(false);
    return machine::InterfaceState{call.link, node_.interface_is_on(line_of(call.link))};
  }
  std::optional<machine::Notice> operator()(const machine::CreateChannel& call) const {
    const auto mode =
        call.mode == machine::Mode::kPowerSave ? node::Mode::kPowerSave : node::Mode::kReliable;
    const node::Address peer = wire_address(call.peer);
    const node::ChannelResult made = call.direction == machine::Direction::kOut
                                         ? node_.create_out(peer, call.size, mode)
                                         : node_.create_in(peer, call.size, mode);
    return machine::ChannelResult{made.id, made.success};
  }
  std::optional<machine::Notice> operator()(const machine::DisposeChannel& call) const {
    return result(node_.dispose(call.id));
  }
  std::optional<machine::Notice> operator()(const machine::StartChannel& call) const {
    return result(node_.start_channel(call.id));
  }
  std::optional<machine::Notice> operator()(const machine::StopChannel& call) const {
    return result(node_.stop_channel(call.id));
  }
  std::optional<machine::Notice> operator()(const machine::StartAllChannels&) const {
    return result(node_.start_all());
  }
  std::optional<machine::Notice> operator()(const machine::StopAllChannels&) const {
    return result(node_.stop_all());
  }
  std::optional<machine::Notice> operator()(const machine::WriteOutput& call) const {
    return result(node_.write_output(call.id, call.pos, call.value));
  }
  std::optional<machine::Notice> operator()(const machine::ReadInput& call) const {
    const node::InputValue value = node_.read_input(call.id, call.pos);
    return machine::InputValue{value.value, value.success};
  }
  std::optional<machine::Notice> operator()(const machine::SetTimeStep& call) const {
    return result(node_.set_time_step(call.ticks));
  }
  std::optional<machine::Notice> operator()(const machine::SetIslandId& call) const {
    return result(node_.set_island(call.island));
  }
  std::optional<machine::Notice> operator()(const machine::GetClock&) const {
    return machine::Clock{node_.clock_ms()};
  }

 private:
  static machine::Notice result(bool success) { return machine::OperationResult{success}; }
  static node::Line line_of(machine::Link link) {
    return link == machine::Link::kRadio ? node::Line::kRadio : node::Line::kSerial;
  }

  node::Node& node_;
};

}  // namespace

OwnLayer::OwnLayer(const node::Setup& setup, node::Ticks gone_after, LayerUser& user)
    : user_(user), role_(setup.role), node_(*this, *this) {
  node_.start(setup);
  silence_.start(gone_after);
}

std::optional<node::Ticks> OwnLayer::run(node::Ticks now) {
  now_ = now;
  node::Ticks due = 0;
  bool runs = node_.run(now, due);
  node::Ticks gone = 0;
  if (silence_.run(node_, *this, now, gone)) {
    if (!runs || node::is_reached(gone, due)) due = gone;
    runs = true;
  }
  return runs ? std::optional(due) : std::nullopt;
}

void OwnLayer::received(node::Line line, Bytes packet) {
  // A mote's node has no memory to count in.
  const bool counts = role_ == node::Role::kSink && line == node::Line::kSerial;
  if (counts && node_.finds_no_room(line, packet)) ++dropped_;
  node_.received(line, packet);
  silence_.received(node_, role_, line, packet, now_);
}

std::optional<machine::Notice> OwnLayer::call(const machine::Call& call) {
  return std::visit(Performer(node_), call);
}

node::Refusal OwnLayer::refusal(const machine::Send& send) const {
  return node_.refusal(wire_address(send.dest), send.reliable, send.data.size());
}

void OwnLayer::transmit(node::Line line, Bytes packet, bool link_ack) {
  user_.transmit(line, packet, link_ack);
}

void OwnLayer::joined(node::Address own, bool success) {
  user_.happened(machine::Joined{address_of(own), success});
}

void OwnLayer::mote_joined(node::Address mote, const node::Descriptor& descriptor) {
  user_.happened(machine::MoteJoined{address_of(mote), descriptor_of(descriptor)});
}

void OwnLayer::mote_left(node::Address mote) {
  user_.happened(machine::MoteLeft{address_of(mote)});
}

void OwnLayer::received(node::Address src, std::uint8_t app_id, Bytes data) {
  user_.happened(machine::Received{address_of(src), app_id, data});
}

void OwnLayer::ack_received(std::uint8_t app_id, std::uint16_t seq_num, bool success) {
  user_.happened(machine::AckReceived{app_id, seq_num, success});
}

void OwnLayer::syn_data_received(node::ChannelId channel, node::DataStatus status) {
  user_.happened(machine::SynDataReceived{channel, static_cast<machine::DataStatus>(status)});
}

}  // namespace rubric::run
