#include "tools/commands/explore_transitions.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/reflect/suggest.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/commands/transitions_format.h"

namespace rubric::tools {

void add_transition_options(cli::Command& sub, TransitionOptions& options) {
  cli::Option wanted =
      sub.add_flag("--transitions", options.wanted,
                   "Print the state diagrams of a node's parts instead, as the machine makes them");
  sub.exclude_all_but(wanted, {"--profile", "--flaw", "--format", "--out"});
  sub.add_option("--part", options.parts,
                 "Print transitions of this part alone: join, listing, message, output, input")
      .needs(wanted);
}

void print_transitions(const TransitionOptions& options, const ExploredMachine& machine,
                       const std::string& format, const std::string& out) {
  std::vector<std::string> names;
  for (const explore::PartName& part : explore::part_names()) names.emplace_back(part.name);
  for (const std::string& part : options.parts) {
    if (std::find(names.begin(), names.end(), part) != names.end()) continue;
    throw cli::UsageError(
        fmt::format("unknown part '{}'{}", part, reflect::did_you_mean(part, names)));
  }
  std::vector<explore::Diagram> diagrams;
  for (const std::string& name : names) {
    const bool wanted =
        options.parts.empty() ||
        std::find(options.parts.begin(), options.parts.end(), name) != options.parts.end();
    if (wanted) diagrams.push_back(explore::transitions_of(name, machine.values, machine.step));
  }
  const std::string text = format == "json"
                               ? transitions_json(diagrams, machine.profile, machine.flaw)
                           : format == "dot" ? transitions_dot(diagrams)
                                             : transitions_text(diagrams);
  if (!cli::write_file(out.empty() ? "-" : out, text)) cli::exit_with(cli::kExitOutput);
  for (const explore::Diagram& diagram : diagrams) {
    if (!diagram.complete) cli::exit_with(cli::kExitIncomplete);
  }
}

}  // namespace rubric::tools
