// The promises of one node, held against whatever happens to it: the explorer's properties without
// its small world, and what holds for the machine as a function. README.md says which are which.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conformance/explorer/history.h"
#include "conformance/flaws/flaws.h"
#include "conformance/runner/subject.h"
#include "conformance/script/script.h"

namespace rubric::script {

using machine::Ticks;

/// The first promise that was broken.
struct Broken {
  std::string name;      ///< Of the explorer's property, or `structure`.
  std::string sentence;  ///< What should have held.
  std::vector<ReqId> requirements;
  Ticks time = 0;
  /// "one_terminal at 3000 (J5-ONCE J8-FAIL): Each joinIsland call ends ..."
  std::string text() const;
};

/// The machine, or a flaw around it, that is watched at every step.
class Watched : public runner::Subject {
 public:
  explicit Watched(flaws::StepFunction of = machine::step) : step_(of) {}

  void start(const machine::Config& config) override;
  void step(Ticks now, const machine::Event& event, machine::Actions& actions) override;
  runner::DueTimers timers() const override;

  /// The script is over: what should have ended by now has.
  void finish(Ticks now);
  const std::optional<Broken>& broken() const { return broken_; }
  /// Of this many steps the node gets its timers; a clock of a tick could run for ever.
  static constexpr std::size_t kTimedStepsMax = 2000;

 private:
  struct Seen : explorer::Observed {
    std::vector<machine::Frame> handled;  // Frames that were looked at in this step, in order.
  };

  void breaks(explorer::Property property, Ticks now);
  void overdue(Ticks now);
  void must(bool holds, const char* sentence, Ticks now, ReqId rule = ReqId::kNone);

  void same_again(const Seen& seen);
  void check_labels(const Seen& seen);
  void check_frames(const Seen& seen);
  void check_bounds(const Seen& seen);

  flaws::StepFunction step_;
  machine::Config config_;  // As it started: a flaw may change the state's.
  machine::State state_;
  explorer::History history_;
  std::optional<Broken> broken_;
  Ticks last_ = 0;
  std::size_t steps_ = 0;
};

/// Lets a script happen to the machine, or to a flaw around it. Nothing: all promises were kept.
std::optional<Broken> watch(const Script& script, flaws::StepFunction step = machine::step);

}  // namespace rubric::script
