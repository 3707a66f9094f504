// Named flaws of release 1.0, each a wrapper around the machine's step, without a switch inside the
// machine. The explorer must find them; broken implementations for the runner are made of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>

#include "conformance/machine/step.h"

namespace rubric::flaws {

/// Thrown by a step that kills the node.
class Died : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Like machine::step, but may throw Died; without a state of its own.
using StepFunction = void (*)(machine::State&, machine::Ticks, const machine::Event&,
                              machine::Actions&);

/// Where a flaw is visible at all.
enum class Seen : std::uint8_t {
  kJoin,      ///< In joins.
  kMessages,  ///< In reliable messages after a join.
  kTime,      ///< Only with a clock that runs.
};

struct Flaw {
  const char* name;
  const char* description;            ///< The behaviour of a flawed node.
  std::array<ReqId, 3> requirements;  ///< The rules that it breaks; kNone fills up.
  Seen seen;
  StepFunction step;
  std::span<const machine::Role> roles = {};  ///< That the node plays; empty: every role.
};

std::span<const Flaw> all();
/// Returns nodes that do all that is known of release 1.0; none of all().
std::span<const Flaw> whole_releases();
/// Returns the flaw or whole release of that name, or null.
const Flaw* find(std::string_view name);

}  // namespace rubric::flaws
