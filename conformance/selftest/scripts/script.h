// The events of one node: how it starts, and which inputs it gets when. This is the input of the
// stateful fuzz targets; bytes.h has its binary form, rtr.h converts it from and to golden traces.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/machine/event.h"
#include "conformance/machine/state.h"
#include "conformance/test/runner/target.h"

namespace rubric::script {

using machine::Ticks;

/// An input, `delay` ticks after the step before: a frame, a call, the end of a radio transmission
/// that asked for a link ack, a line or the application busy, power.
struct Step {
  Ticks delay = 0;
  machine::Event event;             ///< Its bytes are empty: they are `bytes`.
  std::vector<std::uint8_t> bytes;  ///< Payload of a frame, data of a send.

  /// Returns the event with its bytes, which are those of this step.
  machine::Event event_with_bytes() const;
};

struct Script {
  machine::Config config;
  std::vector<Step> steps;
  Ticks rest = 0;  ///< Time after the last step.

  Ticks length() const;
};

// Bounds of every script that decode() makes; golden traces keep them.
constexpr std::size_t kStepsMax = 256;
constexpr Ticks kLengthMax = 1U << 17;  ///< All delays together; about two minutes.
constexpr Ticks kRestMax = 0xFFFF;
constexpr std::size_t kSendBytesMax = 255;  ///< More than a node accepts (N1-SIZE).

/// A node's outputs, and when each step was given.
struct Played {
  std::vector<runner::Output> outputs;
  std::vector<std::size_t> before;  ///< For each step: the number of outputs before it.
};

/// Gives a target the whole script after a reset. Link acks are handled as by the runner: while
/// steps with one are still to come, only these end transmissions that ask for one.
Played play(const Script& script, runner::Target& target);

/// Returns whether it is `deployed`; the number of channels does not matter.
bool is_deployed(const machine::Profile& profile);

}  // namespace rubric::script
