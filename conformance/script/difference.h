// The reference machine and the independent C++ node, given the same: what the rules leave free is
// no difference. README.md lists what that is.
#pragma once

#include <optional>
#include <string>

#include "conformance/flaws/flaws.h"
#include "conformance/script/rtr.h"
#include "conformance/script/script.h"
#include "conformance/trace/trace.h"

namespace rubric::script {

struct Difference {
  std::string text;    ///< On what they differ; empty: on nothing.
  trace::File file;    ///< What the C++ node was held against.
  std::size_t steps = 0;  ///< Of the script that were compared; the others are beyond the rules.
};

/// Lets the script happen to both, as far as the rules decide what comes of it. The machine's run
/// becomes a golden trace in which numbers, times and orders that are free are left open, and the
/// runner holds the C++ node against it.
/// `step` may put a flaw in the machine's place.
Difference difference(const Script& script, flaws::StepFunction step = machine::step);

// Parts of that.

/// Without the steps of which no rule says what they do, in profile paper.
Script without_undecided(const Script& script);
/// As long as what happens is decided by the rules alone, on the machine.
Script until_free(Script script, flaws::StepFunction step = machine::step);
/// Numbers in answers to the node that are not those of its requests and sends become ones that no
/// node has used either: each node chooses its own, and a guess might be the other's.
Script without_guesses(Script script, flaws::StepFunction step = machine::step);
/// The machine's run of a script, as a trace that asks for no more than the rules do: whatever
/// numbers a node begins with, `script` being without_guesses().
trace::File lenient_file(const Script& script, const Played& played, const Title& title);

}  // namespace rubric::script
