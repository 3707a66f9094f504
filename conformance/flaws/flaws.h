// Named flaws of release 1.0, each a wrapper around the machine's step: what broken motes and sinks
// do, without a switch inside the machine. The explorer must find them; broken implementations for
// the runner are made of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "conformance/machine/step.h"

namespace rubric::flaws {

/// As machine::step; without a state of its own.
using StepFunction = void (*)(machine::State&, machine::Ticks, const machine::Event&,
                              machine::Actions&);

/// Where a flaw can be seen at all.
enum class Seen : std::uint8_t {
  kJoin,      ///< In joins.
  kMessages,  ///< In reliable messages after a join.
  kTime,      ///< Only with a clock that runs.
};

struct Flaw {
  const char* name;
  const char* description;            ///< What a flawed node does.
  std::array<ReqId, 3> requirements;  ///< That it breaks; kNone fills up.
  Seen seen;
  StepFunction step;
};

std::span<const Flaw> all();
/// Null: there is none of that name.
const Flaw* find(std::string_view name);

}  // namespace rubric::flaws
