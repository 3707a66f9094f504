// Calls, news and states of a node: as messages of a trace, and as the machine has them.
#pragma once

#include <optional>

#include "conformance/machine/event.h"
#include "conformance/trace/concrete.h"

namespace rubric::events {

/// A call as a trace shows it.
trace::Message from_call(const machine::Call& call);
/// What an application is told, as a trace shows it.
trace::Message from_notice(const machine::Notice& notice);

/// The call that a message names (trace::concrete makes it of a line); its bytes are those of
/// `message`, which must outlive it. Nothing if it is no call.
std::optional<machine::Call> to_call(const trace::Concrete& message);
std::optional<machine::Notice> to_notice(const trace::Concrete& message);
/// busy, idle, linkack, reboot and off; `link` is the link of the line, kApp for the application.
std::optional<machine::Event> to_state(const trace::Concrete& message, trace::LinkKind link);

/// The machine's line of that kind; nothing for app and power.
std::optional<machine::Link> to_link(trace::LinkKind kind);

}  // namespace rubric::events
