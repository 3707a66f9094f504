// Implementations as the subcommands that work traces one by one use them.
#pragma once

#include <memory>
#include <string>

#include "conformance/attach/attachment.h"
#include "conformance/shrink/predicates.h"

namespace rubric::tools {

/// An attached implementation that plays traces. Throws std::invalid_argument (the target makes no
/// sense) and runner::TargetBroken (it cannot be believed).
class AttachedPlayer {
 public:
  AttachedPlayer(const std::string& target, double timeout_seconds, std::string profile);

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
