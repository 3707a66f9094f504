// Mutants that nobody thought of: made of what the machine is seen to do in the golden traces, so
// that a new message, notice or rule is covered by itself.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "conformance/mutants/hunt.h"

namespace rubric::mutants {

/// Calls `see` after each step of the machine in each golden trace, with the state before it.
using Witness = std::function<void(const State& before, Ticks now, const Event&, const State& after,
                                   const Actions&)>;
void watch(const Golden& golden, const Witness& see);

/// What an action is: "send J3-REPLY join_reply", "tell J5-SUCCESS joined"; empty for labels.
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

/// Each kind of action dropped, doubled, and delayed by a period.
Mutants action_mutants(const Golden& golden);
/// Each field of each frame, and of each notice, plus one, and with its highest bit turned.
Mutants field_mutants(const Golden& golden);
/// Each `ignored` of a rule turned into acceptance, in each way that leaves nothing to ignore.
Mutants acceptance_mutants(const Golden& golden);
/// The rules that are named by an `ignored` which no way turned into acceptance.
std::vector<std::string> never_accepted(const Golden& golden);

Mutants generated_mutants(const Golden& golden);

/// A way to take what a rule ignores: mends the frame, or the state for this one step.
struct Mend {
  const char* name;
  /// False: not applicable; nothing was done then.
  bool (*step)(Moment&);
};
std::span<const Mend> mends();

}  // namespace rubric::mutants
