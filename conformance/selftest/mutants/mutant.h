// Broken machines: each is the machine with a wrapper that makes one mistake. The golden traces
// must find every one of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "conformance/selftest/mutants/wrapped.h"
#include "conformance/trace/parameters.h"

namespace rubric::mutants {

struct Mutant {
  std::string name;
  std::string breaks;               ///< In a sentence.
  std::vector<ReqId> requirements;  ///< Rules that it breaks: a failing line must name one.
  StepMaker step;
  /// What the machine must do before the mutant differs from it: kinds_of() has the word. Empty:
  /// anything.
  std::string acts_on = {};

  runner::SubjectFactory factory() const { return wrapped(step); }
};
using Mutants = std::vector<Mutant>;

inline void add(Mutants& out, std::string name, std::string breaks, std::vector<ReqId> requirements,
                StepMaker step) {
  out.push_back({std::move(name), std::move(breaks), std::move(requirements), std::move(step)});
}

/// Add common mistakes, by the family of the rule that they break. Names are unique.
void network_mutants(Mutants& out);       ///< N1 to N5.
void island_mutants(Mutants& out);        ///< N6 to N9.
void control_mutants(Mutants& out);       ///< N10 to N12.
void mote_join_mutants(Mutants& out);     ///< J, at motes: requests, timer, ends.
void mote_accept_mutants(Mutants& out);   ///< J, at motes: replies and their ack_join.
void sink_join_mutants(Mutants& out);     ///< J, at sinks.
void delivery_mutants(Mutants& out);      ///< T1, T2: to and from applications.
void transport_mutants(Mutants& out);     ///< T2 to T4: acks.
void synaptic_mutants(Mutants& out);      ///< S1 to S3.
void channel_life_mutants(Mutants& out);  ///< S4 to S6.
/// Returns all of these, and the flaws of release 1.0 (conformance/machine/flaws).
Mutants named_mutants();

// Unusual nodes that keep every rule, in ways that the decisions allow: no golden trace may fail on
// one.

struct LawfulVariant {
  std::string name;
  std::string reading;  ///< Its behaviour, and the decision that allows it.
  StepMaker step;
  bool weak = false;  ///< A decision calls it weak.
  trace::Statement stated = {};
};

std::vector<LawfulVariant> lawful_variants();
/// Those that are lawful since they state it.
std::vector<LawfulVariant> stated_variants();

/// Makes each frame wait for the channel before it leaves by radio, up to `most` ticks.
StepMaker backing_off(std::uint32_t seed, Ticks most);

}  // namespace rubric::mutants
