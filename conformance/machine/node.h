// A node in the middle of a step: what the files of the machine hand each other.
#pragma once

#include "conformance/machine/actions.h"
#include "conformance/machine/join.h"
#include "conformance/machine/route.h"
#include "conformance/machine/state.h"
#include "conformance/machine/step.h"

namespace rubric::machine {

struct Node {
  State& state;
  Ticks now;
  Actions& actions;

  const Config& config() const { return state.config; }
  const Profile& profile() const { return state.config.profile; }
};

/// Virtual time in ms.
inline std::uint32_t ms_of(const Node& node) {
  const std::uint64_t per_second = node.profile().ticks_per_second;
  return static_cast<std::uint32_t>(std::uint64_t{node.now} * 1000 / per_second);
}
inline std::uint32_t clock_ms(const Node& node) {
  return ms_of(node) + node.state.clock_offset_ms;
}

inline Router router_of(const State& state) {
  const bool mote = state.config.role == Role::kMote;
  const bool member = !mote || state.join.phase == JoinMote::Phase::kMember;
  const std::uint16_t sink = mote && member ? state.join.sink_devid : state.config.profile.sink_id;
  return {state.config.role, own_address(state), member, sink};
}

inline JoinContext join_context(const Node& node) {
  return {node.profile(), node.config().id, node.state.island, clock_ms(node), node.now};
}

// receive.cc

/// A line brought a frame.
void hear(Node& node, const Frame& frame);
/// The application has time again: what waited is handled. (N2)
void handle_waiting(Node& node);

// network.cc

/// A net_msg of this node's own; dest.pid may be kLocalPid. Returns its sequence number, or kNoSeq
/// and in `refused` the rule. `requirement` is the transmission's unless it is kNone; then the
/// route says it.
struct OwnMessage {
  Address dest;
  std::uint8_t trans_id = 0;
  std::uint8_t app_id = 0;
  bool reliable = false;
  Bytes data;
  ReqId requirement = ReqId::kNone;
};
std::uint16_t send_own(Node& node, const OwnMessage& message, ReqId& refused);
/// A net_msg that was heard.
void hear_net_msg(Node& node, Link from, Bytes bytes);
/// A sink tells its base station of a new member, or remembers that it has to. (J6)
void report_joined(Node& node, const Admission& member);
/// Reports that found the serial line full or off, and now find room.
void report_owed(Node& node);
/// The synaptic clock ticks.
void tick(Node& node);
/// A sink's or base station's island changes. (N9)
void set_island(Node& node, std::uint16_t island);

// call.cc

void call(Node& node, const Call& call);

}  // namespace rubric::machine
