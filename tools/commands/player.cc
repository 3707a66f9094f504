#include "tools/commands/player.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "codec/text/text.h"
#include "conformance/test/suite/canary.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/targets/groups.h"
#include "conformance/trace/headers.h"
#include "conformance/trace/print.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/verdict.h"
#include "tools/commands/stated.h"

namespace rubric::tools {

void add_player_options(cli::Command& app, PlayerOptions& options) {
  app.add_option("-o,--out", options.out, "Write the trace to this file; - is stdout");
  app.add_option("--timeout", options.timeout_seconds,
                 "Wait at most this many seconds for an answer")
      .between(0.01, 3600.0);
  add_state_option(app, options.stated);
  app.add_option("--seed", options.seed, "Seed what is random in nodes, where a trace has no seed")
      .check(cli::whole_number)
      .between(std::uint64_t{0}, suite::kSeedMax);
}

void run_player_command(const cli::Command& app, const std::vector<std::string>& names,
                        const std::function<void()>& work) {
  if (std::any_of(names.begin(), names.end(), targets::is_command)) targets::guard_children();
  targets::end_groups_on_signals();
  try {
    work();
  } catch (const cli::Ending&) {  // An exit code that was chosen.
    throw;
  } catch (const std::invalid_argument& error) {
    throw cli::UsageError(error.what());
  } catch (const runner::TargetBroken& error) {
    text::print(stderr, "rubric {}: {}\n", app.name(), error.what());
    cli::exit_with(cli::kExitBroken);
  } catch (const std::runtime_error& error) {
    cli::unreadable(error.what());
  }
}

trace::File seeded(const trace::File& file, const trace::Case& one, const PlayerOptions& options) {
  trace::File out = shrink::only(file, one);
  if (options.seed) trace::set_seed_if_none(out, one, *options.seed);
  return out;
}

AttachedPlayer::AttachedPlayer(const std::string& target, const PlayerOptions& options,
                               std::string profile)
    : profile_(std::move(profile)) {
  targets::Options how;
  how.stated = statement_of(options.stated);
  how.step_timeout = std::chrono::milliseconds(static_cast<int>(options.timeout_seconds * 1000));
  attachment_ = targets::attach(target, how);
  suite::require_honest(*attachment_, target, options.seed);
}

shrink::Player AttachedPlayer::player() {
  return {[this](const trace::NodeHeader&) { return attachment_->target(); }, profile_,
          attachment_->identity().stated};
}

std::string AttachedPlayer::name() {
  const targets::Identity& identity = attachment_->identity();
  std::string out = identity.name;
  if (!identity.version.empty()) out += " " + identity.version;
  if (!profile_.empty()) out += " (profile " + profile_ + ")";
  return out;
}

std::string outcome_text(const runner::CaseResult& result) {
  const std::string_view verdict = runner::verdict_text(result.verdict);
  if (result.failures.empty()) {
    return result.reason.empty() ? std::string(verdict)
                                 : fmt::format("{}: {}", verdict, result.reason);
  }
  const runner::Failure& first = result.failures.front();
  return fmt::format("{}: {}{}{}", verdict, fmt::join(first.requirements, " "),
                     first.requirements.empty() ? "" : ": ", first.text);
}

std::string shrunk_text(const shrink::Shrunk& shrunk, const std::string& name,
                        const std::vector<std::string>& comments) {
  trace::File file = shrunk.file;
  trace::Case& one = file.cases.at(0);
  one.name = name;
  std::vector<trace::Item> items;
  for (const std::string& text : comments) {
    std::string line = text;
    for (char& c : line) {
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    }
    items.push_back(trace::Comment{';', false, " " + line});
  }
  one.items.insert(one.items.begin(), items.begin(), items.end());
  return trace::print(file);
}

}  // namespace rubric::tools
