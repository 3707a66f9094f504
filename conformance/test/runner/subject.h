// An implementation in this process that is stepped as the machine is: the machine itself, or a
// broken or unusual one around it.
#pragma once

#include <functional>
#include <memory>

#include "conformance/machine/step.h"

namespace rubric::runner {

using machine::DueTimers;

class Subject {
 public:
  virtual ~Subject() = default;
  /// Forgets everything and starts with `config`.
  virtual void start(const machine::Config& config) = 0;
  virtual void step(machine::Ticks now, const machine::Event& event, machine::Actions& actions) = 0;
  virtual DueTimers timers() const = 0;
};

/// The reference machine, or one whose step is wrapped in a flaw.
class Machine : public Subject {
 public:
  using StepFunction = void (*)(machine::State&, machine::Ticks, const machine::Event&,
                                machine::Actions&);
  explicit Machine(StepFunction function = machine::step) : step_(function) {}
  void start(const machine::Config& config) override { state_ = machine::start(config); }
  void step(machine::Ticks now, const machine::Event& event, machine::Actions& actions) override {
    step_(state_, now, event, actions);
  }
  DueTimers timers() const override { return machine::timers(state_); }
  const machine::State& state() const { return state_; }

 protected:
  machine::State state_;

 private:
  StepFunction step_;
};

using SubjectFactory = std::function<std::unique_ptr<Subject>()>;

}  // namespace rubric::runner
