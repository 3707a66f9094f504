// Broken machines: each is the machine with a wrapper that makes one mistake. The golden traces
// must find every one of them.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "conformance/selftest/mutants/hunt.h"
#include "conformance/selftest/mutants/wrapped.h"
#include "conformance/trace/parameters.h"

namespace rubric::mutants {

struct Mutant {
  std::string name;
  std::string breaks;               ///< In a sentence.
  std::vector<ReqId> requirements;  ///< Rules that it breaks: a failing line must name one.
  StepMaker step;

  runner::SubjectFactory factory() const { return wrapped(step); }
};
using Mutants = std::vector<Mutant>;

inline void add(Mutants& out, std::string name, std::string breaks, std::vector<ReqId> requirements,
                StepMaker step) {
  out.push_back({std::move(name), std::move(breaks), std::move(requirements), std::move(step)});
}

/// Return common mistakes, by the family of the rule that they break. Names are unique.
Mutants network_mutants();       ///< N1 to N5.
Mutants island_mutants();        ///< N6 to N9.
Mutants control_mutants();       ///< N10 to N12.
Mutants mote_join_mutants();     ///< J, at motes: requests, timer, ends.
Mutants mote_accept_mutants();   ///< J, at motes: replies and their ack_join.
Mutants sink_join_mutants();     ///< J, at sinks.
Mutants delivery_mutants();      ///< T1, T2: to and from applications.
Mutants transport_mutants();     ///< T2 to T4: acks.
Mutants synaptic_mutants();      ///< S1 to S3.
Mutants channel_life_mutants();  ///< S4 to S6.
/// Returns all of these, and the flaws of release 1.0 (conformance/machine/flaws).
Mutants named_mutants();

// Mutants made from the machine's observed actions in the golden traces, so that a new message,
// notice or rule is covered without further work.

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

// Unusual nodes that keep every rule, in ways that the decisions allow: no golden trace may fail on
// one.

struct LegalVariant {
  std::string name;
  std::string reading;  ///< Its behaviour, and the decision that allows it.
  StepMaker step;
  bool weak = false;  ///< A decision calls it weak.
  trace::Statement stated = {};
};

std::vector<LegalVariant> legal_variants();
/// Those that are legal since they state it.
std::vector<LegalVariant> stated_variants();

/// Makes each frame wait for the channel before it leaves by radio, up to `most` ticks.
StepMaker backing_off(std::uint32_t seed, Ticks most);

}  // namespace rubric::mutants
