// What happens to one node: how it starts, and what it is given when. The input of the stateful
// fuzz targets; bytes.h has its binary form, rtr.h leads from and to golden traces.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/machine/event.h"
#include "conformance/machine/state.h"
#include "conformance/runner/target.h"

namespace rubric::script {

using machine::Ticks;

/// Something from outside, `delay` ticks after the step before: a frame, a call, how a radio
/// transmission that asked for a link ack ended, a line or the application busy, power.
struct Step {
  Ticks delay = 0;
  machine::Event event;             ///< Its bytes are empty: they are `bytes`.
  std::vector<std::uint8_t> bytes;  ///< Payload of a frame, data of a send.

  /// The event with its bytes, which are those of this step.
  machine::Event whole() const;
};

struct Script {
  machine::Config config;
  std::vector<Step> steps;
  Ticks rest = 0;  ///< What passes after the last step.

  Ticks length() const;
};

// Bounds of every script that decode() makes; golden traces keep them.
constexpr std::size_t kStepsMax = 256;
constexpr Ticks kLengthMax = 1U << 17;  ///< All delays together; about two minutes.
constexpr Ticks kRestMax = 0xFFFF;
constexpr std::size_t kSendBytesMax = 120;  ///< More than a node accepts (N1-SIZE).

/// What came back from a node, and when in it each step was given.
struct Played {
  std::vector<runner::Output> outputs;
  std::vector<std::size_t> before;  ///< Of each step: how many outputs had come.
};

/// Gives a target the whole script from its reset on. Link acks as the runner has them: while steps
/// with one are still to come, transmissions that ask for one end by them alone.
Played play(const Script& script, runner::Target& target);

/// A profile with another number of channels is the same profile.
bool is_deployed(const machine::Profile& profile);

}  // namespace rubric::script
