// Converts calls, news and states of a node between messages of a trace and the machine's types.
#pragma once

#include <optional>

#include "conformance/machine/event.h"
#include "conformance/trace/concrete.h"

namespace rubric::events {

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
