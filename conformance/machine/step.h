// The reference machine: one node of the RUBICON Communication Layer, without I/O, clock or chance.
#pragma once

#include <cstdint>

#include "conformance/machine/actions.h"
#include "conformance/machine/event.h"
#include "conformance/machine/state.h"

namespace rubric::machine {

/// Returns a node that has just started.
State start(const Config& config);

/// Applies `event`, which happens at `now`: changes the state in place and fills `actions` (cleared
/// first) with the consequences and their rules. Never fails: an impossible event, such as a timer
/// that is not set, is ignored. `now` does not go backwards.
void step(State& state, Ticks now, const Event& event, Actions& actions);

/// A timer that is set, and when it is due.
struct DueTimer {
  Ticks due = 0;
  Timer timer;
};
/// Join timer, silence and synaptic clock, and the ack timeouts.
using DueTimers = BoundedList<DueTimer, 3 + kAwaitedMax>;
/// Returns all timers that are set, unordered.
DueTimers timers(const State& state);

/// Returns the own address now: pid 0 if a mote is not a member.
Address own_address(const State& state);

/// Hashes everything that step() can see.
std::uint64_t hash_value(const State& state);

}  // namespace rubric::machine
