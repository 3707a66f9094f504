// Scripts from golden traces, and runs of scripts as golden traces.
#pragma once

#include <string>
#include <vector>

#include "conformance/runner/run_case.h"
#include "conformance/script/script.h"
#include "conformance/trace/trace.h"

namespace rubric::script {

struct CaseScript {
  std::string node;
  Script script;
  std::vector<runner::Output> outputs;  ///< Of the reference machine in the case.
};

/// A script for each node under test: what the runner gives it when all of them are the reference
/// machine. Throws std::runtime_error where the case cannot be worked, or is beyond a script's
/// bounds.
std::vector<CaseScript> scripts_of(const trace::File& file, const trace::Case& one);

/// What a trace says about itself.
struct Title {
  std::string case_name;              ///< As `repro.one_terminal`.
  std::vector<std::string> comments;  ///< Behind the case's name.
  /// Rules that are broken where the node emits more than it did in this run.
  std::vector<ReqId> rules;
};

/// A trace that asks for exactly that run, to the tick, and for nothing more; trace::check() finds
/// nothing wrong with it.
trace::File to_file(const Script& script, const Played& run, const Title& title);

// Parts of that, for traces that ask for less.

/// The node of a script's trace, and the line that shows an output or a step.
trace::NodeHeader node_of(const Script& script);
trace::File begin_file(const Script& script);
trace::Line line_of(const runner::Output& output, const std::string& node);
trace::Line line_of(const Step& step, Ticks now, const std::string& node);
/// `!>`: nothing but what other lines take, from the start to `end`. It stands first, so that it
/// counts even where the case ends at a line that finds nothing.
trace::Line nothing_else(Ticks end, const std::string& node, const std::vector<ReqId>& rules);

}  // namespace rubric::script
