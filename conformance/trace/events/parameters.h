// What the parameters of a trace mean to the machine.
#pragma once

#include <cstdint>

#include "conformance/machine/profile.h"
#include "conformance/trace/parameters.h"

namespace rubric::events {

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

}  // namespace rubric::events
