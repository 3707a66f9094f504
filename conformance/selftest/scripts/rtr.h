// Makes scripts from golden traces, and golden traces from runs of scripts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "conformance/selftest/scripts/script.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/trace/trace.h"

namespace rubric::script {

struct CaseScript {
  std::string case_name;
  std::string node;
  Script script;
  std::vector<runner::Output> outputs;  ///< By the reference machine in the case.

  std::string name() const { return case_name + "." + node; }
};

/// Returns a script for each node under test of each case below the folder: the runner's inputs to
/// it when all of them are the reference machine; none for a node that is given more bytes at once,
/// more often, or for longer, than a script can. Throws std::runtime_error if a case cannot be run,
/// or exceeds a script's other bounds.
std::vector<CaseScript> golden_scripts(const std::filesystem::path& folder = "conformance/cases");

/// Titles in the trace.
struct Title {
  std::string case_name;              ///< For example `repro.one_terminal`.
  std::vector<std::string> comments;  ///< After the case's name.
  /// Rules that are broken if the node emits more than it did in this run.
  std::vector<ReqId> rules;
};

/// Returns a trace that requires exactly that run, to the tick, and nothing more; trace::check()
/// finds nothing wrong with it.
trace::File to_file(const Script& script, const Played& run, const Title& title);

/// Returns such a trace of other lines, which are made of the outputs and steps in their order.
trace::File to_file(const Script& script, const Played& run, const Title& title,
                    const std::function<trace::Line(const runner::Output&)>& shown,
                    const std::function<trace::Line(const Step&, Ticks now)>& given);

// Parts of that, for traces that require less.

/// Return the node of a script's trace, and the line that shows an output or a step.
trace::NodeHeader node_of(const Script& script);
trace::Line line_of(const runner::Output& output, const std::string& node);
/// Returns the number of a message that was accepted, if the output says it.
std::optional<std::uint16_t> number_sent(const runner::Output& output);
trace::Line line_of(const Step& step, Ticks now, const std::string& node);

}  // namespace rubric::script
