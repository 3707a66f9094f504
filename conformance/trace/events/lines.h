// What is given to a node of the machine, and what it does, as lines of a trace.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/machine/actions.h"
#include "conformance/machine/event.h"
#include "conformance/machine/profile.h"
#include "conformance/machine/state.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/parameters.h"

namespace rubric::events {

/// What a trace calls a node and its lines.
struct NodeNames {
  std::string node;
  std::string radio;
  std::string serial;
  std::string peis = "peis";
  std::uint8_t radio_group = 0;  ///< Group of the AM packets that stand for its radio frames.

  const std::string& link(machine::Link link) const;
};

/// Returns the header of a node under test: its role, id and island.
trace::NodeHeader header_of(const machine::Config& config, std::string name);

trace::LinkKind kind_of(machine::Link link);
trace::AmFrame frame_of(const NodeNames& names, const machine::Frame& frame);
/// Returns the packet that stands for the frame in rct/1 and on serial lines.
std::vector<std::uint8_t> packet_of(const machine::Frame& frame);

/// Nothing for timers, which no line shows.
std::optional<trace::Line> given_line(std::int64_t now, const NodeNames& names,
                                      const machine::Event& event);
/// With the rule that the node followed, if it names one.
trace::Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Frame& frame,
                         ReqId rule);
trace::Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Notice& notice,
                         ReqId rule);
/// The lines of all frames and notices, in order.
std::vector<trace::Line> emitted_lines(std::int64_t now, const NodeNames& names,
                                       const machine::Actions& actions);

/// Returns the value that a profile has for it.
std::int64_t value_of(const machine::Profile& profile, trace::ParameterId id);
/// Returns the value that golden windows assume of a node of this profile that states none. It
/// differs where a runner owns the line, which is never busy (decision 128), and where release 1.0
/// has no timeout.
std::int64_t assumed(const machine::Profile& profile, trace::ParameterId id);

/// Returns how what is stated contradicts itself ("ack_timeout=198 leaves ..."), or nothing.
std::string contradiction(const trace::Statement& statement);

/// Sets what is stated.
void state(machine::Profile& profile, const trace::Statement& statement);

/// Returns a call as a trace shows it.
trace::Message from_call(const machine::Call& call);
/// Returns a notice as a trace shows it.
trace::Message from_notice(const machine::Notice& notice);

/// Returns the call that a message names (trace::concrete makes it of a line); its bytes are those
/// of `message`, which must outlive it. Nothing if it is no call.
std::optional<machine::Call> to_call(const trace::Concrete& message);
std::optional<machine::Notice> to_notice(const trace::Concrete& message);
/// Returns busy, idle, linkack, reboot and off; `link` is the link of the line, kApp for the
/// application.
std::optional<machine::Event> to_state(const trace::Concrete& message, trace::LinkKind link);

/// Returns the machine's line of that kind; nothing for app and power.
std::optional<machine::Link> to_link(trace::LinkKind kind);

}  // namespace rubric::events
