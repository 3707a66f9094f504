#include "tools/commands/run/calls.h"

#include "conformance/machine/messages.h"

namespace rubric::run {
namespace {

using machine::Notice;

node::Address wire_address(machine::Address address) { return {address.pid, address.devid}; }

// A result of each call, by overloading.
class Performer {
 public:
  explicit Performer(node::Node& node) : node_(node) {}

  std::optional<Notice> operator()(const machine::JoinIsland& call) const {
    node_.join(machine::wire_of(call.descriptor));
    return std::nullopt;
  }
  std::optional<Notice> operator()(const machine::Send& call) const {
    return machine::SendResult{
        node_.send(wire_address(call.dest), call.app_id, call.reliable, call.data)};
  }
  std::optional<Notice> operator()(const machine::SetInterface& call) const {
    return result(node_.set_interface(line_of(call.link), call.on));
  }
  std::optional<Notice> operator()(const machine::GetInterface& call) const {
    if (call.link == machine::Link::kPeis) return result(false);
    return machine::InterfaceState{call.link, node_.interface_is_on(line_of(call.link))};
  }
  std::optional<Notice> operator()(const machine::CreateChannel& call) const {
    const auto mode =
        call.mode == machine::Mode::kPowerSave ? node::Mode::kPowerSave : node::Mode::kReliable;
    const node::Address peer = wire_address(call.peer);
    const node::ChannelResult made = call.direction == machine::Direction::kOut
                                         ? node_.create_out(peer, call.size, mode)
                                         : node_.create_in(peer, call.size, mode);
    return machine::ChannelResult{made.id, made.success};
  }
  std::optional<Notice> operator()(const machine::DisposeChannel& call) const {
    return result(node_.dispose(call.id));
  }
  std::optional<Notice> operator()(const machine::StartChannel& call) const {
    return result(node_.start_channel(call.id));
  }
  std::optional<Notice> operator()(const machine::StopChannel& call) const {
    return result(node_.stop_channel(call.id));
  }
  std::optional<Notice> operator()(const machine::StartAllChannels&) const {
    return result(node_.start_all());
  }
  std::optional<Notice> operator()(const machine::StopAllChannels&) const {
    return result(node_.stop_all());
  }
  std::optional<Notice> operator()(const machine::WriteOutput& call) const {
    return result(node_.write_output(call.id, call.pos, call.value));
  }
  std::optional<Notice> operator()(const machine::ReadInput& call) const {
    const node::InputValue value = node_.read_input(call.id, call.pos);
    return machine::InputValue{value.value, value.success};
  }
  std::optional<Notice> operator()(const machine::SetTimeStep& call) const {
    return result(node_.set_time_step(call.ticks));
  }
  std::optional<Notice> operator()(const machine::SetIslandId& call) const {
    return result(node_.set_island(call.island));
  }
  std::optional<Notice> operator()(const machine::GetClock&) const {
    return machine::Clock{node_.clock_ms()};
  }

 private:
  static Notice result(bool success) { return machine::OperationResult{success}; }
  static node::Line line_of(machine::Link link) {
    return link == machine::Link::kRadio ? node::Line::kRadio : node::Line::kSerial;
  }

  node::Node& node_;
};

}  // namespace

std::optional<Notice> perform(const machine::Call& call, node::Node& node) {
  return std::visit(Performer(node), call);
}

}  // namespace rubric::run
