// A Subject with the runner's clock: its timers fire when due, its transmissions take their time on
// the line, and the radio confirms frames that ask for it.
#pragma once

#include <memory>
#include <vector>

#include "conformance/test/runner/subject.h"
#include "conformance/test/runner/target.h"

namespace rubric::runner {

/// Returns how long a frame of so many payload bytes occupies a line: 802.15.4 at 250 kbit/s,
/// serial at 115200 baud; rounded up to a tick.
Ticks transmission_ticks(machine::Link link, std::size_t payload_bytes);

class SubjectTarget : public Target {
 public:
  explicit SubjectTarget(std::unique_ptr<Subject> subject) : subject_(std::move(subject)) {}

  void reset(const machine::Config& config) override;
  void give(Ticks now, const machine::Event& event) override;
  std::optional<Ticks> next() const override;
  Ticks run_until(Ticks time) override;
  const std::vector<Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool hold) override { hold_link_acks_ = hold; }

  /// Returns every rule that a step named since reset, with the action.
  const std::vector<machine::Action>& labels() const { return labels_; }
  Subject& subject() { return *subject_; }

 private:
  struct Ending {
    Ticks due = 0;
    machine::Link link = machine::Link::kRadio;
  };
  void run_next_event(Ticks now);
  void step(Ticks now, const machine::Event& event);
  void collect(Ticks now);

  std::unique_ptr<Subject> subject_;
  machine::Actions actions_;
  std::vector<Output> outputs_;
  std::vector<machine::Action> labels_;
  std::vector<Ending> endings_;  // Transmissions under way, at most one a line.
  bool hold_link_acks_ = false;
  Ticks instant_ = 0;
  int steps_at_instant_ = 0;
};

}  // namespace rubric::runner
