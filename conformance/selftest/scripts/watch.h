// Checks the promises of one node in any run: the explorer's properties without its small world,
// and properties of the machine as a function. README.md lists them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conformance/explore/history.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/selftest/scripts/script.h"
#include "conformance/test/runner/subject.h"

namespace rubric::script {

using machine::Ticks;

/// The first promise that was broken.
struct Broken {
  std::string name;      ///< The explorer's property, or `structure`.
  std::string sentence;  ///< The property that should have held.
  std::vector<ReqId> requirements;
  Ticks time = 0;
  /// Returns "one_terminal at 3000 (J5-ONCE J8-FAIL): Each joinIsland call ends ..."
  std::string text() const;
};

/// The machine, or a flaw around it, checked at every step.
class Watched : public runner::Subject {
 public:
  explicit Watched(flaws::StepFunction of = machine::step) : step_(of) {}

  void start(const machine::Config& config) override;
  void step(Ticks now, const machine::Event& event, machine::Actions& actions) override;
  runner::DueTimers timers() const override;

  /// Checks, after the script, that everything that should have ended has.
  void finish(Ticks now);
  const std::optional<Broken>& broken() const { return broken_; }
  /// The node gets its timers in this many steps; a clock of one tick could run for ever.
  static constexpr std::size_t kTimedStepsMax = 2000;

 private:
  struct Seen : explore::Observed {
    std::vector<machine::Frame> handled;  // Frames handled in this step, in order.
  };

  void breaks(explore::Property property, Ticks now);
  void overdue(Ticks now);
  void must(bool holds, const char* sentence, Ticks now, ReqId rule = ReqId::kNone);

  void same_again(const Seen& seen);
  void check_labels(const Seen& seen);
  void check_frames(const Seen& seen);
  void check_bounds(const Seen& seen);

  flaws::StepFunction step_;
  machine::Config config_;  // The start value: a flaw may change the state's.
  machine::State state_;
  explore::History history_;
  std::optional<Broken> broken_;
  Ticks last_ = 0;
  std::size_t steps_ = 0;
};

/// Runs a script on the machine, or on a flaw around it. Returns the broken promise; nothing if all
/// were kept.
std::optional<Broken> watch(const Script& script, flaws::StepFunction step = machine::step);

}  // namespace rubric::script
