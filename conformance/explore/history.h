// The promises that one node can keep or break, whatever the world around it: its history as far as
// they need it, and one step after another compared with it. The explorer keeps a history in every
// state of its small world, script::Watched one along a script of anything.
//
// A promise is looked at from outside, by the frames and events of a step, where these tell enough;
// where they do not (which frame of several was refused, what still waits for a line), by what the
// step did to the node's lists and buffers. Nothing is remembered that a step tells by itself: two
// states of a node that will do the same have to stay one state for the explorer. So
//   - a sink owes its reply to the request that it handles in the same step: it is sent or waits in
//     the buffer at once, and what leaves the buffer later is no new reply;
//   - a mote is listed in the step that handles its ack_join.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "conformance/explore/property.h"
#include "conformance/machine/step.h"

namespace rubric::explore {

/// A reliable message whose receive_ack is awaited by the application.
struct OpenSend {
  std::uint16_t seq_num = 0;
  std::uint8_t app_id = 0;
  machine::Address dest;
  std::optional<machine::Ticks> left;  ///< When a line had it.
  friend bool operator==(const OpenSend&, const OpenSend&) = default;
};

/// What a sink promised one mote.
struct Answered {
  bool armed = false;         ///< Since the last moteJoined.
  std::uint16_t seq_num = 0;  ///< Of the last request that it had to answer.
  friend bool operator==(const Answered&, const Answered&) = default;
};

struct History {
  // A mote. Sets are of islands.
  int open_calls = 0;                    ///< Calls without their terminal event.
  machine::Ticks opened = 0;             ///< When the first of them came.
  bool asked = false;                    ///< It has sent a request: the next three are known.
  int requests = 0;                      ///< Of the present call.
  std::uint16_t present_seq = 0;         ///< Of its last request.
  std::set<std::uint16_t> offers;        ///< Answered that number during the call.
  std::set<std::uint16_t> chosen;        ///< Acked for this call.
  std::set<std::uint16_t> acked;         ///< Acked ever; survives a reboot.
  std::optional<machine::Address> view;  ///< What joined(SUCCESS) told the application.
  // A sink.
  std::map<std::uint16_t, Answered> answered;  ///< By mote.
  bool overwritten = false;                    ///< More joins were pending than it has to remember.
  int owed_reports = 0;                        ///< moteJoined without serial_joined yet.
  bool reports_lost = false;                   ///< Some of them may never be sent.
  // Both.
  std::vector<OpenSend> sends;

  friend bool operator==(const History&, const History&) = default;
};

/// One step of a node. `config` is the one that it started with: a flaw may change the state's.
struct Observed {
  const machine::Config& config;
  const machine::State& before;
  const machine::Event& event;
  const machine::Actions& actions;
  const machine::State& after;
  machine::Ticks now = 0;
};

/// What a step showed.
struct Noted {
  Mask violated = 0;
  Mask goals = 0;
  friend bool operator==(const Noted&, const Noted&) = default;
};

/// The frames that a node looks at in a step, in order: several when its application was busy.
std::vector<machine::Frame> handled_frames(const machine::State& before,
                                           const machine::Event& event);

/// Whether the message with this number, whose ack is awaited, is yet to leave.
bool waits_for_line(const machine::State& state, std::uint16_t seq_num);

/// Follows one step, in which `handled` were looked at.
void observe(History& history, const Observed& step, const std::vector<machine::Frame>& handled,
             Noted& noted);

}  // namespace rubric::explore
