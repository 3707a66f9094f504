// Mutants made from the machine's observed actions in the golden traces, so that a new message,
// notice or rule is covered without further work.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "conformance/selftest/mutants/hunt.h"

namespace rubric::mutants {

/// Calls `see` after each step of the machine in each golden trace, with the state before it.
using Witness = std::function<void(const State& before, Ticks now, const Event&, const State& after,
                                   const Actions&)>;
void watch(const Golden& golden, const Witness& see);

/// Returns the kind of an action: "send J3-REPLY join_reply", "tell J5-SUCCESS joined"; empty for
/// labels.
std::string kind_of(const Action& action, const Actions& actions);

/// A field of a frame that can be changed.
struct Place {
  std::string path;              ///< "am.dest", "dest.pid", "payload.body.seq_num".
  std::size_t offset_bytes = 0;  ///< In the payload; not of the AM addresses.
  std::size_t size_bytes = 0;
  bool little_endian = false;
};
/// The messages from the outermost in, "net_msg rubicon_ack", and every field.
struct Anatomy {
  std::string name;
  std::vector<Place> places;
};
Anatomy anatomy(const Transmit& frame);

/// Returns mutants that drop, double, or delay by a period each kind of action.
Mutants action_mutants(const Golden& golden);
/// Returns mutants that change each field of each frame and notice: plus one, and its highest bit.
Mutants field_mutants(const Golden& golden);
/// Returns mutants that accept where an `ignored` names a rule, in each way that leaves nothing to
/// ignore.
Mutants acceptance_mutants(const Golden& golden);
/// Returns the rules of an `ignored` that no way turned into acceptance.
std::vector<std::string> never_accepted(const Golden& golden);

Mutants generated_mutants(const Golden& golden);

/// A way to accept what a rule ignores: mends the frame, or the state for this one step.
struct Mend {
  std::string name;
  /// Returns false if it is not applicable; it did nothing then.
  std::function<bool(Moment&)> step;
};
std::span<const Mend> mends();

}  // namespace rubric::mutants
