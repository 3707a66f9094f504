// Compares the reference machine and the independent C++ node on the same inputs, except where the
// rules leave a choice. README.md lists these choices.
#pragma once

#include <memory>
#include <string>

#include "conformance/machine/flaws/flaws.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/selftest/scripts/script.h"
#include "conformance/test/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::script {

struct Difference {
  std::string text;       ///< On what they differ; empty: on nothing.
  trace::File file;       ///< The trace that the C++ node was compared with.
  std::size_t steps = 0;  ///< Compared steps of the script; the rules do not decide the others.
};

/// Runs the script on both, as far as the rules decide its results. The machine's run becomes a
/// golden trace with free numbers, times and orders left open, and the runner compares the C++ node
/// with it. `step` may replace the machine by a flaw.
Difference difference(const Script& script, flaws::StepFunction step = machine::step);

// Parts of that.

/// Drops steps whose outcome no rule decides, in profile paper.
Script without_undecided(const Script& script);
/// Cuts the script where the rules alone no longer decide the machine's run.
Script until_free(Script script, flaws::StepFunction step = machine::step);
/// Replaces numbers in answers to the node that are not those of its requests and sends by ones
/// that no node has used: each node chooses its own, and a guess might be the other's.
Script without_guesses(Script script, flaws::StepFunction step = machine::step);
/// Returns the machine's run of a script as a trace that requires no more than the rules do,
/// whatever numbers a node begins with; `script` comes from without_guesses().
trace::File lenient_file(const Script& script, const Played& played, const Title& title);

// The independent C++ node of conformance/node in this process, on lines with the machine's
// timing, so that two implementations differ only in their own behaviour.

std::unique_ptr<runner::Target> cpp_target();

}  // namespace rubric::script
