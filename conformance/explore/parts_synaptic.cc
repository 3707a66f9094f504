// Synaptic channels: the explored networks have none, so a sink is explored alone, with the calls
// and the data of one channel.
#include "conformance/explore/parts.h"
#include "conformance/machine/synaptic.h"
#include "conformance/trace/events/lines.h"

namespace rubric::explore {
namespace {

using machine::Called;
using machine::Channel;
using machine::Mode;
using machine::State;

constexpr machine::Address kSink{kFirstIsland, 1};
constexpr machine::Address kPeer{kFirstIsland, kFirstMoteId};
const machine::ChannelId kOutId = machine::channel_id(kSink.devid, kPeer.devid);
const machine::ChannelId kInId = machine::channel_id(kPeer.devid, kSink.devid);
constexpr machine::Timer kTick{machine::TimerKind::kSynaptic, 0};

enum Life : std::size_t { kAbsent, kStopped, kStarted };

template <class List>
std::size_t life_of(const List& channels) {
  if (channels.empty()) return kAbsent;
  return channels[0].started ? kStarted : kStopped;
}

std::size_t output_state(const State& state) { return life_of(state.synaptic.out); }
std::size_t input_state(const State& state) { return life_of(state.synaptic.in); }

bool has_sink_role(const machine::Config& config) { return config.role == machine::Role::kSink; }

Given given(const machine::Event& event) { return {event, std::nullopt}; }

template <class... Calls>
std::vector<Given> alphabet(const Calls&... calls) {
  return {given(Called{calls})..., given(machine::TimerDue{kTick}), given(machine::Reboot{})};
}

// Returns a call's name, "tick", "data" or "reboot".
std::string name_of(const Given& given) {
  if (given.heard) return "data";
  if (const auto* called = std::get_if<Called>(&given.what)) {
    return events::from_call(called->call).name + "()";
  }
  return std::holds_alternative<machine::TimerDue>(given.what) ? "tick" : "reboot";
}

const char* room_of(const Channel& channel) {
  return channel.size < machine::kConnectionsMax ? "room for a connection" : "no room";
}

std::optional<Trigger> output_trigger(const State& state, const Given& given) {
  std::string name = name_of(given);
  if (const auto* called = std::get_if<Called>(&given.what)) {
    const auto* create = std::get_if<machine::CreateChannel>(&called->call);
    if (create == nullptr) return Trigger{name, ""};
    if (!state.synaptic.out.empty()) return Trigger{name, room_of(state.synaptic.out[0])};
    return Trigger{name, create->mode == Mode::kReliable ? "reliable" : "power-save"};
  }
  if (name != "tick" || state.synaptic.out.empty()) return Trigger{name, ""};
  const Channel& channel = state.synaptic.out[0];
  if (channel.mode == Mode::kReliable) return Trigger{name, "reliable"};
  return Trigger{name, channel.fresh ? "power-save, first or changed" : "power-save, unchanged"};
}

std::optional<Trigger> input_trigger(const State& state, const Given& given) {
  std::string name = name_of(given);
  if (state.synaptic.in.empty()) return Trigger{name, ""};
  if (name == "create_in()") return Trigger{name, room_of(state.synaptic.in[0])};
  if (name != "tick") return Trigger{name, ""};
  return Trigger{name, state.synaptic.in[0].fresh ? "data came" : "no data came"};
}

std::vector<Given> output_alphabet(const machine::Profile&) {
  using machine::CreateChannel;
  using machine::Direction;
  return alphabet(CreateChannel{Direction::kOut, kPeer, 1, Mode::kReliable},
                  CreateChannel{Direction::kOut, kPeer, 1, Mode::kPowerSave},
                  machine::DisposeChannel{kOutId}, machine::StartChannel{kOutId},
                  machine::StopChannel{kOutId}, machine::WriteOutput{kOutId, 0, 1.0F},
                  machine::WriteOutput{kOutId, 0, 2.0F});
}

// Returns the data that the other end sends at its tick.
machine::Transmit data(const machine::Profile& profile) {
  machine::Config config;
  config.id = kPeer.devid;
  config.profile = profile;
  State peer = machine::start(config);
  peer.join.phase = machine::JoinMote::Phase::kMember;
  peer.join.address = kPeer;
  peer.join.acked = true;
  machine::Actions actions;
  machine::step(peer, 0,
                Called{machine::CreateChannel{machine::Direction::kOut, kSink, 1, Mode::kReliable}},
                actions);
  machine::step(peer, 0, Called{machine::StartChannel{kInId}}, actions);
  machine::step(peer, 0, machine::TimerDue{kTick}, actions);
  return actions.transmits()[0];
}

std::vector<Given> input_alphabet(const machine::Profile& profile) {
  std::vector<Given> all =
      alphabet(machine::CreateChannel{machine::Direction::kIn, kPeer, 1, Mode::kReliable},
               machine::DisposeChannel{kInId}, machine::StartChannel{kInId},
               machine::StopChannel{kInId}, machine::ReadInput{kInId, 0});
  all.push_back({{}, data(profile)});
  return all;
}

}  // namespace

PartInfo synaptic_output() {
  return {"output",
          "An output channel of synaptic communication",
          {"no channel", "stopped", "started"},
          has_sink_role,
          output_state,
          output_trigger,
          nullptr,
          output_alphabet};
}

PartInfo synaptic_input() {
  return {"input",
          "An input channel of synaptic communication",
          {"no channel", "stopped", "started"},
          has_sink_role,
          input_state,
          input_trigger,
          nullptr,
          input_alphabet};
}

}  // namespace rubric::explore
