// A node in the middle of a step: functions that the machine's files share.
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

/// Converts virtual time to ms.
inline std::uint32_t ms_of(const Node& node) {
  const std::uint64_t per_second = node.profile().ticks_per_second;
  return static_cast<std::uint32_t>(std::uint64_t{node.now} * 1000 / per_second);
}
inline std::uint32_t clock_ms(const Node& node) { return ms_of(node) + node.state.clock_offset_ms; }

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

/// Handles a frame from a line.
void hear(Node& node, const Frame& frame);
/// Handles waiting frames when the application has time again. (N2)
void handle_waiting(Node& node);

// silence.cc

/// Notes which mote a frame came from, if the node calls silent motes gone. (decision 124)
void note_presence(Node& node, const Frame& frame);
/// Returns when the mote that was heard longest ago is gone; there is one.
Ticks silence_due(const State& state);
/// Forgets the motes that are gone now, and tells the application.
void end_silence(Node& node);

// network.cc

/// Sends a net_msg of this node's own; dest.pid may be kLocalPid. Returns its sequence number, or
/// kNoSeq with the rule in `refused`. `requirement` is the transmission's; if it is kNone, the
/// route's.
struct OwnMessage {
  Address dest;
  std::uint8_t trans_id = 0;
  std::uint8_t app_id = 0;
  bool reliable = false;
  Bytes data;
  ReqId requirement = ReqId::kNone;
};
std::uint16_t send_own(Node& node, const OwnMessage& message, ReqId& refused);
/// Handles a net_msg from a line.
void hear_net_msg(Node& node, Link from, Bytes bytes);
/// Reports a new member to a sink's base station, or remembers that it is owed. (J6)
void report_joined(Node& node, const Admission& member);
/// Sends reports that found the serial line full or off, and now have room.
void report_owed(Node& node);
/// Handles a tick of the synaptic clock.
void tick(Node& node);
/// Changes a sink's or base station's island. (N9)
void set_island(Node& node, std::uint16_t island);

// call.cc

void call(Node& node, const Call& call);

}  // namespace rubric::machine
