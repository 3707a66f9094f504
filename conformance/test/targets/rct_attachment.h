// Processes that use rct/1, kept for reuse.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "conformance/test/targets/rct_target.h"

namespace rubric::targets {

/// Starts a process. Throws runner::TargetBroken.
using Starter = std::function<std::unique_ptr<Process>()>;

/// Gives each target a process of its own, which goes back to the pool while it is sound. Targets
/// must not outlive it.
class RctAttachment : public Attachment {
 public:
  RctAttachment(Starter start, const Options& options)
      : start_(std::move(start)), options_(options) {}

  const Identity& identity() override;
  std::unique_ptr<runner::Target> target() override;
  std::string honesty() override;
  std::string take_stderr() override;
  std::vector<Mishap> take_mishaps() override { return std::exchange(mishaps_, {}); }
  void finish() override;

  /// Returns a process that waits, to be given back.
  std::unique_ptr<RctClient> take();
  void give_back(std::unique_ptr<RctClient> client);

 private:
  bool waits(RctClient& client);
  void keep_stderr(RctClient& client);

  Starter start_;
  Options options_;
  Identity identity_;
  std::vector<std::unique_ptr<RctClient>> idle_;
  std::string stderr_;
  std::vector<Mishap> mishaps_;
};

}  // namespace rubric::targets
