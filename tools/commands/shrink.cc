#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/text/text.h"
#include "conformance/selftest/mutants/mutant.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/suite/cases.h"
#include "conformance/trace/protocol.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/commands/commands.h"
#include "tools/commands/player.h"
#include "tools/commands/protocol_folder.h"

namespace rubric::tools {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;

struct ShrinkOptions {
  std::string protocol;
  std::vector<std::string> references;
  std::string trace;
  std::string target;
  std::string case_name;
  std::string profile;
  PlayerOptions shared;
};

constexpr const char* kShrinkFooter =
    "The result fails at the same line and by the same rule; the reference machine and all its\n"
    "lawful variants pass it, as far as they pass the original. Without any one of its lines it "
    "would\n"
    "not do so. It is a golden trace of its own. Machine and variants are RUBICON's: for another\n"
    "protocol name an implementation that keeps its rules by --reference.\n"
    "Examples:\n"
    "  rubric shrink j4.rtr --target './my_adapter' --case j4.wrong_seq --out small.rtr\n"
    "  rubric test --target './my_adapter' small.rtr\n"
    "Exit codes: 0 done, 2 the kit or the implementation broke, 3 nothing fails, 64 usage,\n"
    "66 the trace cannot be read.";

bool fails(const CaseResult& result) {
  return result.verdict == CaseVerdict::kFail || result.verdict == CaseVerdict::kError;
}
bool passes(const CaseResult& result) {
  return result.verdict == CaseVerdict::kPass || result.verdict == CaseVerdict::kWeak;
}

struct Failing {
  trace::File file;  // With this case alone.
  CaseResult result;
};

std::optional<Failing> find_failing(const suite::Cases& cases, const ShrinkOptions& options,
                                    const shrink::Player& player) {
  for (const suite::SuiteCase& each : cases.all()) {
    if (!options.case_name.empty() && each.one->name != options.case_name) continue;
    trace::File file = seeded(each.file->file, each.whole(), options.shared);
    CaseResult result = shrink::play(file, player);
    if (fails(result)) return Failing{std::move(file), std::move(result)};
  }
  return std::nullopt;
}

// Returns the user's references, and for RUBICON the reference machine and its lawful variants with
// what is stated, as far as they pass a trace.
std::vector<shrink::Player> references(
    const trace::File& file, const trace::Statement& stated,
    const std::vector<std::unique_ptr<AttachedPlayer>>& attached) {
  std::vector<shrink::Player> all;
  const auto add = [&](const shrink::Player& one) {
    const bool good = passes(shrink::play(file, one));
    if (good) all.push_back(one);
    return good;
  };
  for (const auto& one : attached) {
    if (add(one->player())) continue;
    throw cli::UsageError("--reference", one->name() + " does not pass the trace itself");
  }
  const auto add_machine = [&](const runner::SubjectFactory& make) {
    add({[make](const trace::NodeHeader&) {
           return std::make_unique<runner::SubjectTarget>(make());
         },
         "", stated});
  };
  if (trace::protocol().has_machine) {
    add_machine([] { return std::make_unique<runner::Machine>(); });
    for (const mutants::LawfulVariant& one : mutants::lawful_variants()) {
      add_machine(mutants::wrapped(one.step));
    }
  }
  return all;
}

void shrink_it(const ShrinkOptions& options) {
  std::vector<std::string> traces = {options.trace};
  use_protocol(options.protocol, {options.profile}, traces);
  const suite::Cases cases = suite::Cases::of(traces);
  if (!options.case_name.empty() && !cases.find(options.case_name)) {
    throw cli::UsageError(options.trace + " has no case " + options.case_name);
  }
  AttachedPlayer attached(options.target, options.shared, options.profile);
  const shrink::Player player = attached.player();
  cli::keep_apart("--out", options.shared.out, {options.trace});
  const auto found = find_failing(cases, options, player);
  if (!found) {
    text::print(stderr, "nothing fails: there is nothing to shrink\n");
    cli::exit_with(cli::kExitIncomplete);
  }
  const trace::Case& one = found->file.cases.at(0);
  std::vector<std::unique_ptr<AttachedPlayer>> others;
  for (const std::string& target : options.references) {
    others.push_back(std::make_unique<AttachedPlayer>(target, options.shared, options.profile));
  }
  const auto shows =
      shrink::fails_alike(found->result, player, references(found->file, player.stated, others));
  const shrink::Shrunk shrunk = shrink::shrink(found->file, one, shows);
  const std::string& name = one.name;
  if (shrunk.lines_before == 0) {
    if (!shrink::fails_alike(found->result, player, {})(found->file)) {
      throw runner::TargetBroken(name + " does not fail in the same way twice; is a seed ignored?");
    }
    text::print(
        stderr,
        "{} fails, but not all nodes that keep the rules pass it: a decision leaves open what "
        "it asks for, so that there is nothing to shrink\n",
        name);
    cli::exit_with(cli::kExitIncomplete);
  }
  const CaseResult last = shrink::play(shrunk.file, player);
  const std::string text = shrunk_text(
      shrunk, name + ".shrunk",
      {fmt::format("{} of the {} lines of {}.", shrunk.lines, shrunk.lines_before, name),
       fmt::format("On {}: {}", attached.name(), outcome_text(last))});
  if (!cli::write_file(options.shared.out, text)) cli::exit_with(cli::kExitOutput);
  text::print(stderr, "{}: {} lines shrank to {} in {} runs\n{}\n", name, shrunk.lines_before,
              shrunk.lines, shrunk.tried, outcome_text(last));
}

}  // namespace

void add_shrink(cli::Command& app) {
  auto options = std::make_shared<ShrinkOptions>();
  cli::Command& sub = app.add_subcommand("shrink", "Make a failing trace as small as it can be");
  sub.footer(kShrinkFooter);
  sub.add_option("TRACE", options->trace, "A .rtr file").required();
  sub.add_option("--target", options->target, "Run this implementation, as in rubric test")
      .required();
  add_protocol_option(sub, options->protocol);
  sub.add_option("--reference", options->references,
                 "Require that this implementation passes the result; again for another one")
      .one_at_a_time();
  sub.add_option("--case", options->case_name, "Shrink this case (default: the first that fails)");
  sub.add_option("--profile", options->profile,
                 "Keep to paper or deployed (default: as the trace says)")
      .one_of({"paper", "deployed"});
  add_player_options(sub, options->shared);
  sub.callback([options, &sub] {
    std::vector<std::string> targets = options->references;
    targets.push_back(options->target);
    run_player_command(sub, targets, [&] { shrink_it(*options); });
  });
}

}  // namespace rubric::tools
