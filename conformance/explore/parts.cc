#include "conformance/explore/parts.h"

#include <fmt/format.h>

#include <array>

#include "conformance/machine/join.h"
#include "conformance/machine/synaptic.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/events/lines.h"

namespace rubric::explore {
namespace {

using machine::Called;
using machine::Channel;
using machine::JoinMote;
using machine::Mode;
using machine::State;
using trace::Message;
using trace::Value;

// The parts are the joins and messages of the first mote and the first sink.
constexpr std::uint16_t kMote = kFirstMoteId;

bool is_mote(const machine::Config& config) {
  return config.role == machine::Role::kMote && config.id == kMote;
}
bool is_sink(const machine::Config& config) {
  return config.role == machine::Role::kSink && config.island == kFirstIsland;
}

std::int64_t number_at(const Message& message, std::string_view path) {
  const Value* value = message.find(path);
  return value != nullptr && value->is(Value::Kind::kNumber) ? value->number : -1;
}

// Returns one half of an address such as 11:5; -1 for a reserved one.
std::int64_t half_at(const Message& message, std::string_view path, std::size_t half) {
  const Value* value = message.find(path);
  if (value == nullptr || value->items.size() != 2) return -1;
  const Value& item = value->items[half];
  return item.is(Value::Kind::kNumber) ? item.number : -1;
}

std::string plural(unsigned count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// ---- A mote's join.

enum Join : std::size_t { kOutside, kJoining, kAcking, kConfirmed, kUnconfirmed };

std::size_t join_state(const State& state) {
  const JoinMote& join = state.join;
  switch (join.phase) {
    case JoinMote::Phase::kOutside: return kOutside;
    case JoinMote::Phase::kJoining: return kJoining;
    case JoinMote::Phase::kMember: break;
  }
  if (join.acked) return kConfirmed;
  return state.radio.sending_ack_join ? kAcking : kUnconfirmed;
}

std::optional<Trigger> join_trigger(const State& state, const Given& given) {
  const machine::Profile& profile = state.config.profile;
  if (given.heard) {
    const Message message = message_of(*given.heard);
    if (message.name != "join_reply") return std::nullopt;
    const bool own = number_at(message, "seq_num") == state.join.seq_num;
    if (state.join.phase == JoinMote::Phase::kOutside) return Trigger{"join_reply", ""};
    if (state.join.phase == JoinMote::Phase::kMember) {
      const bool second = own && number_at(message, "island_addr") != state.join.address.pid;
      return Trigger{"join_reply", second ? "another island's offer" : ""};
    }
    return Trigger{"join_reply", own ? "its number" : "another number"};
  }
  if (const auto* called = std::get_if<machine::Called>(&given.what)) {
    if (!std::holds_alternative<machine::JoinIsland>(called->call)) return std::nullopt;
    return Trigger{"joinIsland()", ""};
  }
  if (const auto* due = std::get_if<machine::TimerDue>(&given.what)) {
    if (due->timer.kind != machine::TimerKind::kJoin) return std::nullopt;
    const bool more = state.join.requests < profile.join_requests_max;
    return Trigger{"join timer", fmt::format("{} {}", more ? "before" : "after",
                                             plural(profile.join_requests_max, "request"))};
  }
  if (const auto* done = std::get_if<machine::SendDone>(&given.what)) {
    if (done->link != machine::Link::kRadio || !state.radio.sending_ack_join) return std::nullopt;
    if (done->acked) return Trigger{"link ack", ""};
    const bool more = state.join.acks < profile.ack_join_max;
    return Trigger{"no link ack", fmt::format("{} {}", more ? "before" : "after",
                                              plural(profile.ack_join_max, "ack_join"))};
  }
  if (std::holds_alternative<machine::Reboot>(given.what)) return Trigger{"reboot", ""};
  return std::nullopt;
}

std::vector<Options> join_networks(const machine::Profile& profile) {
  Options options{.profile = profile, .sinks = 2};
  options.loss = options.dup = options.reorder = true;
  options.calls = 2;
  options.reboots = 1;
  return {options};
}

// ---- A sink's view of one mote.

enum Listing : std::size_t { kUnknown, kAnswered, kListed, kListedAnswered };

std::size_t listing_state(const State& state) {
  const bool listed = machine::find_member(state.sink, kMote) != nullptr;
  const bool pending = machine::find_pending(state.sink, kMote) != nullptr;
  if (listed) return pending ? kListedAnswered : kListed;
  return pending ? kAnswered : kUnknown;
}

bool is_full(const State& state) {
  return state.sink.members.size() >= state.config.profile.members_max;
}

std::optional<Trigger> listing_trigger(const State& state, const Given& given) {
  if (std::holds_alternative<machine::Reboot>(given.what) && !given.heard) {
    return Trigger{"reboot", ""};
  }
  if (!given.heard) return std::nullopt;
  const Message message = message_of(*given.heard);
  const machine::Admission* const member = machine::find_member(state.sink, kMote);
  const machine::Admission* const pending = machine::find_pending(state.sink, kMote);
  const char* const room = is_full(state) && member == nullptr ? "no room in its list" : "";
  if (message.name == "join_request" && given.heard->src == kMote) {
    return Trigger{"join_request", room};
  }
  if (message.name != "ack_join" || half_at(message, "src", 1) != kMote) return std::nullopt;
  if (half_at(message, "dest", 0) != state.island) return Trigger{"ack_join", "for another island"};
  const std::int64_t number = number_at(message, "seq_num");
  const machine::Admission* const stored = pending != nullptr ? pending : member;
  if (stored == nullptr) return Trigger{"ack_join", "for its island"};
  if (stored->seq_num != number) return Trigger{"ack_join", "another number"};
  return Trigger{"ack_join", *room != '\0' ? "its number, no room in its list" : "its number"};
}

std::vector<Options> listing_networks(const machine::Profile& profile) {
  Options two_sinks = join_networks(profile).front();
  Options full;  // A list of one place, and two motes that want it.
  full.profile = profile;
  full.profile.members_max = 1;
  full.profile.join_requests_max = 2;
  full.profile.ack_join_max = 2;
  full.motes = 2;
  full.loss = full.dup = true;
  return {two_sinks, full};
}

// ---- A message at its sender.

enum Sending : std::size_t { kIdle, kAwaited };

std::size_t message_state(const State& state) { return state.awaited.empty() ? kIdle : kAwaited; }

std::optional<Trigger> message_trigger(const State& state, const Given& given) {
  if (state.awaited.size() > 1) return std::nullopt;  // The diagram follows one message.
  if (given.heard) {
    const Message message = message_of(*given.heard);
    const Value* kind = message.find("payload.trans_id");
    if (kind == nullptr || kind->text != "rubicon_ack") return std::nullopt;
    if (state.join.phase != JoinMote::Phase::kMember) return Trigger{"ack", "not a member"};
    if (state.awaited.empty()) return Trigger{"ack", "a member"};
    const bool own = number_at(message, "payload.body.seq_num") == state.awaited[0].seq_num;
    return Trigger{"ack", own ? "its number" : "another number"};
  }
  if (const auto* called = std::get_if<machine::Called>(&given.what)) {
    const auto* send = std::get_if<machine::Send>(&called->call);
    if (send == nullptr || !state.awaited.empty()) return std::nullopt;
    return Trigger{send->reliable ? "send(reliable)" : "send(unreliable)",
                   !state.radio.sending     ? "radio free"
                   : state.radio.out.full() ? "radio's buffer full"
                                            : "radio busy"};
  }
  if (const auto* due = std::get_if<machine::TimerDue>(&given.what)) {
    if (due->timer.kind != machine::TimerKind::kAck) return std::nullopt;
    return Trigger{"ack timer", ""};
  }
  if (std::holds_alternative<machine::Reboot>(given.what)) return Trigger{"reboot", ""};
  return std::nullopt;
}

std::vector<Options> message_networks(const machine::Profile& profile) {
  Options options{.profile = profile};
  options.profile.join_requests_max = 1;
  options.profile.ack_join_max = 1;
  options.scope = Scope::kFull;
  options.sends = 2;
  options.loss = options.dup = true;
  options.dups = 1;
  options.reboots = 1;
  return {options};
}

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
  machine::Config config{.id = kPeer.devid, .profile = profile};
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

std::span<const PartInfo> parts() {
  static const std::array<PartInfo, 5> kParts{{
      {"join",
       "How a mote joins an island",
       {"not a member", "request out", "member,\nack_join on the air",
        "member,\nack_join confirmed", "member,\nack_join unconfirmed"},
       is_mote,
       join_state,
       join_trigger,
       join_networks,
       nullptr},
      {"listing",
       "How a sink lists a mote",
       {"not known", "answered", "listed", "listed,\nanswered again"},
       is_sink,
       listing_state,
       listing_trigger,
       listing_networks,
       nullptr},
      {"message",
       "How a message ends at the mote that sent it",
       {"no ack awaited", "ack awaited"},
       is_mote,
       message_state,
       message_trigger,
       message_networks,
       nullptr},
      {"output",
       "An output channel of synaptic communication",
       {"no channel", "stopped", "started"},
       has_sink_role,
       output_state,
       output_trigger,
       nullptr,
       output_alphabet},
      {"input",
       "An input channel of synaptic communication",
       {"no channel", "stopped", "started"},
       has_sink_role,
       input_state,
       input_trigger,
       nullptr,
       input_alphabet},
  }};
  return kParts;
}

const PartInfo* find_part(std::string_view name) {
  for (const PartInfo& part : parts()) {
    if (name == part.name) return &part;
  }
  return nullptr;
}

Message message_of(const machine::Transmit& frame) {
  return trace::decode(events::frame_of({}, frame.frame()), events::kind_of(frame.link)).message;
}

}  // namespace rubric::explore
