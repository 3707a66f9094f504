// Implementations as the subcommands that work traces one by one use them.
#pragma once

#include "tools/cli/command.h"
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/attach/attachment.h"
#include "conformance/shrink/predicates.h"

namespace rubric::tools {

/// What such subcommands have in common.
struct PlayerOptions {
  std::string out = "-";                ///< Where the trace goes.
  double timeout_seconds = 5;
  std::optional<std::uint64_t> seed;    ///< Of the nodes, where a trace has none.
};

/// Adds --out, --timeout and --seed, and the exit codes of verdicts.
void add_player_options(cli::Command& app, PlayerOptions& options);

/// `work` with its exceptions as what the user reads on stderr and as exit codes: 2 the kit or an
/// implementation broke, 64 usage, 66 a trace cannot be read.
void run_player_command(const cli::Command& app, const std::function<void()>& work);

/// One case of a file, with the headers that hold for it and the seed if it has none.
trace::File seeded(const trace::File& file, const trace::Case& one, const PlayerOptions& options);

/// An attached implementation that plays traces. Throws std::invalid_argument (the target makes no
/// sense) and runner::TargetBroken (it cannot be believed).
class AttachedPlayer {
 public:
  AttachedPlayer(const std::string& target, const PlayerOptions& options, std::string profile);

  /// Valid as long as this lives.
  shrink::Player player();
  /// "tiny_mote 0.3".
  std::string name();

 private:
  std::unique_ptr<attach::Attachment> attachment_;
  std::string profile_;
};

/// "fails (J4-SEQ: ...)", "passes".
std::string outcome_text(const runner::CaseResult& result);

/// The file as text, with comments behind the case's name.
std::string shrunk_text(const shrink::Shrunk& shrunk, const std::string& name,
                        const std::vector<std::string>& comments);

}  // namespace rubric::tools
