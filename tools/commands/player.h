// Opens a `--target` for subcommands that run one trace at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/test/shrink/shrink.h"
#include "conformance/test/targets/attachment.h"
#include "tools/cli/command.h"

namespace rubric::tools {

/// The common options of such subcommands.
struct PlayerOptions {
  std::string out = "-";  ///< The trace's destination.
  double timeout_seconds = 5;
  std::vector<std::string> stated;
  std::optional<std::uint64_t> seed;  ///< For the nodes, if a trace has none.
};

/// Adds --out, --timeout, --state and --seed, and the exit codes of verdicts.
void add_player_options(cli::Command& app, PlayerOptions& options);

/// Runs `work`, which plays these targets; prints its exceptions on stderr and turns them into exit
/// codes: 2 the kit or an implementation broke, 64 usage, 66 a trace cannot be read.
void run_player_command(const cli::Command& app, const std::vector<std::string>& targets,
                        const std::function<void()>& work);

/// Returns one case of a file, with the headers that apply to it and the seed if it has none.
trace::File seeded(const trace::File& file, const trace::Case& one, const PlayerOptions& options);

/// An attached implementation that plays traces. Throws std::invalid_argument (the target makes no
/// sense) and runner::TargetBroken (it cannot be believed).
class AttachedPlayer {
 public:
  AttachedPlayer(const std::string& target, const PlayerOptions& options, std::string profile);

  /// Returns a player, valid as long as this lives.
  shrink::Player player();
  /// Returns "tiny_mote 0.3".
  std::string name();

 private:
  std::unique_ptr<targets::Attachment> attachment_;
  std::string profile_;
};

/// Returns "fails (J4-SEQ: ...)", "passes".
std::string outcome_text(const runner::CaseResult& result);

/// Returns the file as text, with comments after the case's name.
std::string shrunk_text(const shrink::Shrunk& shrunk, const std::string& name,
                        const std::vector<std::string>& comments);

}  // namespace rubric::tools
