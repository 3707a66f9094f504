#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "codec/text/text.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/select.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/commands/commands.h"
#include "tools/commands/player.h"
#include "tools/commands/protocol_folder.h"

namespace rubric::tools {
namespace {

struct DiffOptions {
  std::string protocol;
  std::vector<std::string> traces;
  std::vector<std::string> targets;
  std::vector<std::string> profiles;
  suite::Selection selection;
  PlayerOptions shared;
};

constexpr const char* kDiffFooter =
    "Two implementations differ where one keeps a line of a golden trace that the other breaks,\n"
    "or dies where the other does not; freedom within the rules is no difference. Cases in which\n"
    "both die are named, not compared. The eight smallest traces that tell them apart are made\n"
    "as small as they can be, and the shortest is printed.\n"
    "Examples:\n"
    "  rubric diff --target ./old_mote --target ./new_mote\n"
    "  rubric diff --target machine --target machine --profile paper --profile deployed\n"
    "  rubric diff --protocol my_protocol --target './old_node' --target './new_node'\n"
    "Exit codes: 0 no difference, 1 they differ, 2 the kit or an implementation broke,\n"
    "3 no case could be compared, 64 usage, 66 a trace cannot be read.";

void compare(DiffOptions options) {
  use_protocol(options.protocol, options.profiles, options.traces);
  if (options.targets.size() != 2) throw cli::UsageError("--target must be given twice");
  if (!options.profiles.empty() && options.profiles.size() != 2) {
    throw cli::UsageError("--profile must be given twice, once for each target");
  }
  const suite::Cases cases =
      options.traces.empty() ? suite::Cases::own() : suite::Cases::of(options.traces);
  std::vector<std::unique_ptr<AttachedPlayer>> players;
  for (std::size_t i = 0; i < 2; ++i) {
    players.push_back(std::make_unique<AttachedPlayer>(
        options.targets[i], options.shared,
        options.profiles.empty() ? std::string() : options.profiles[i]));
  }
  std::vector<trace::File> files;
  for (const suite::SuiteCase& each : suite::select(cases, options.selection)) {
    files.push_back(seeded(each.file->file, each.whole(), options.shared));
  }
  std::vector<const trace::File*> pointers;
  for (const trace::File& file : files) pointers.push_back(&file);
  const shrink::DifferenceSearch found =
      shrink::find_difference(pointers, players[0]->player(), players[1]->player());
  if (!found.both_died.empty()) {
    text::print(stderr, "{} not compared, since both died, hung or wrote nonsense\n",
                found.both_died.size());
    for (const std::string& name : found.both_died) text::print(stderr, "  {}\n", name);
  }
  if (found.compared == 0) {
    text::print(stderr, "no case could be compared\n");
    cli::exit_with(cli::kExitIncomplete);
  }
  text::print(stderr, "{} cases compared, {} differ, {} that one of them cannot play\n",
              found.compared, found.different.size(), found.skipped);
  for (const std::string& name : found.different) text::print(stderr, "  {}\n", name);
  if (!found.shortest) {
    if (found.different.empty()) return;
    throw runner::TargetBroken("they differ by chance only: not twice in the same case");
  }
  if (!options.traces.empty()) cli::keep_apart("--out", options.shared.out, options.traces);
  const shrink::Difference& difference = *found.shortest;
  const std::string text =
      shrunk_text(difference.shrunk, difference.case_name + ".difference",
                  {fmt::format("A, {}: {}", players[0]->name(), outcome_text(difference.a)),
                   fmt::format("B, {}: {}", players[1]->name(), outcome_text(difference.b))});
  if (!cli::write_file(options.shared.out, text)) cli::exit_with(cli::kExitOutput);
  cli::exit_with(cli::kExitFindings);
}

}  // namespace

void add_diff(cli::Command& app) {
  auto options = std::make_shared<DiffOptions>();
  cli::Command& sub =
      app.add_subcommand("diff", "Find the shortest trace on which two implementations differ");
  sub.footer(kDiffFooter);
  sub.add_option("TRACES", options->traces,
                 "Golden traces and folders of them; default: those of the kit")
      .type_name("TRACE");
  add_protocol_option(sub, options->protocol);
  sub.add_option("--target", options->targets,
                 "Compare this implementation, as in rubric test; twice")
      .required()
      .repeatable();
  sub.add_option("--profile", options->profiles,
                 "Set the profile of each target (default: as traces say)")
      .one_of({"paper", "deployed"})
      .repeatable();
  sub.add_option("--cases", options->selection.globs, "Compare only cases with such names")
      .repeatable();
  sub.add_option("--rule", options->selection.requirements,
                 "Compare only cases that try this rule or family")
      .repeatable();
  for (const char* name : {"--target", "--profile", "--cases", "--rule"}) {
    sub.get_option(name).one_at_a_time();  // One at a time: traces may follow.
  }
  add_player_options(sub, options->shared);
  sub.callback(
      [options, &sub] { run_player_command(sub, options->targets, [&] { compare(*options); }); });
}

}  // namespace rubric::tools
