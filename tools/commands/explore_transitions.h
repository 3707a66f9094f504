// rubric explore --transitions: draws state diagrams of the parts of a node, from the machine's
// steps.
#pragma once

#include <string>
#include <vector>

#include "conformance/explore/transitions.h"
#include "tools/cli/command.h"

namespace rubric::tools {

struct TransitionOptions {
  bool wanted = false;
  std::vector<std::string> parts;  ///< None: all.
};

/// Adds --transitions and --part; they choose the network, so of the existing options only those
/// for profile, flaw and output may be given with them.
void add_transition_options(cli::Command& sub, TransitionOptions& options);

/// The machine to explore, by name.
struct ExploredMachine {
  std::string profile;
  machine::Profile values;
  std::string flaw;  ///< Empty: none.
  explore::StepFunction step = machine::step;
};

/// Prints the diagrams and ends the subcommand if that or the search failed.
void print_transitions(const TransitionOptions& options, const ExploredMachine& machine,
                       const std::string& format, const std::string& out);

}  // namespace rubric::tools
