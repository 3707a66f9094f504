// The second channel to a node at its line: a program that speaks rct/1 for what the line does not
// show, such as the calls and news of its application (PORTING.md).
#pragma once

#include <memory>
#include <vector>

#include "conformance/test/targets/rct_target.h"

namespace rubric::targets {

/// One node of one case. All but the accessors may throw runner::TargetBroken and
/// runner::Unsupported. Times of outputs are the program's, and mean nothing to the line.
class AppChannel {
 public:
  AppChannel(std::unique_ptr<RctClient> client, RctTarget::GiveBack give_back)
      : client_(std::move(client)), give_back_(std::move(give_back)) {}
  ~AppChannel() { give_back_(std::move(client_)); }
  AppChannel(const AppChannel&) = delete;
  AppChannel& operator=(const AppChannel&) = delete;

  /// Returns the links that it shows.
  runner::Reach shown() const;
  /// Starts the node, if the program can, and returns when it has said so.
  /// `own` is what the node states.
  void reset(const machine::Config& config, const trace::Statement& own);
  /// Gives an event and returns what the program says then.
  std::vector<Output> give(const machine::Event& event);
  /// Returns what has happened since.
  std::vector<Output> poll();

 private:
  std::vector<Output> ask(std::string command, bool passes_time);

  std::unique_ptr<RctClient> client_;
  RctTarget::GiveBack give_back_;
  Ticks now_ = 0;  // By the program's clock.
};

}  // namespace rubric::targets
