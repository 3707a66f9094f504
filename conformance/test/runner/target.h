// An implementation under test on a clock that the runner turns, wherever it runs.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "codec/lines/broken.h"
#include "conformance/machine/step.h"
#include "conformance/trace/concrete.h"

namespace rubric::runner {

using machine::Ticks;

/// An output of the implementation: a frame on a line, or news for its application.
struct Output {
  Ticks time = 0;
  bool is_frame = false;
  machine::Transmit frame;           ///< If it is a frame.
  trace::Message news;               ///< Else: an event of the protocol, with all its fields.
  ReqId requirement = ReqId::kNone;  ///< The rule that the implementation names; often none.
};

/// The target broke: it died, hangs, or sends nonsense. An error of the case.
using TargetBroken = lines::Broken;
/// It broke at the start of a node, after it had said who it is: a failure of the case.
class BrokenAtReset : public TargetBroken {
 public:
  using TargetBroken::TargetBroken;
};
/// The target reports that it cannot do this. The case is skipped.
class Unsupported : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The target cannot be what the case is for: it is not built with what that states of its node, or
/// its clock, which we do not turn, would take too long.
class NotBuilt : public Unsupported {
 public:
  using Unsupported::Unsupported;
};

/// The implementation's own program answered that it does not do this.
class Refused : public Unsupported {
 public:
  using Unsupported::Unsupported;
};

/// The part of a node that a target lets the runner see and do. A node behind a serial line shows
/// only that line.
struct Reach {
  bool radio = true;
  bool serial = true;
  bool peis = true;
  bool app = true;  ///< Calls, events, power, and whether lines are busy.
};

/// A span of time with both ends included.
struct Window {
  Ticks from = 0;
  Ticks to = 0;
  bool holds(Ticks time) const { return from <= time && time <= to; }
};

/// How many ticks a target's times may be off. Zeros if the runner turns its clock.
struct Tolerance {
  Ticks early = 0;
  Ticks late = 0;
};

/// All but the accessors may throw TargetBroken and Unsupported.
class Target {
 public:
  virtual ~Target() = default;
  /// Makes it a node of a trace that has just started, at tick 0. The base class knows RUBICON's
  /// alone, and calls reset().
  virtual void start(const trace::Scope& scope, const trace::NodeHeader& node);
  /// Makes it a node of RUBICON that has just started, at tick 0.
  virtual void reset(const machine::Config& config) = 0;
  /// Gives an event from outside. Time does not go backwards.
  virtual void give(Ticks now, const machine::Event& event) = 0;
  /// Gives a call of the application. The base class knows RUBICON's alone, and calls give().
  virtual void call(Ticks now, const trace::Concrete& message);
  /// Returns the time before which it surely does nothing on its own, unless it is given something;
  /// nothing: never.
  virtual std::optional<Ticks> next() const = 0;
  /// Lets time pass up to and including `time`, but stops at the first instant at which it emits
  /// something, when all of that instant is done. Returns the instant that is reached.
  virtual Ticks run_until(Ticks time) = 0;
  /// Returns all outputs since reset, in order.
  virtual const std::vector<Output>& outputs() const = 0;
  /// While set, frames that ask for a link ack end when the runner gives SendDone, not before.
  virtual void hold_link_acks(bool hold) = 0;

  virtual Reach reach() const { return {}; }
  virtual Tolerance tolerance() const { return {}; }
  /// Returns when the last event was given, if that took time: between these ticks. Outputs before
  /// it have earlier times; the others do not.
  virtual std::optional<Window> given() const { return std::nullopt; }
  /// Returns why inputs or outputs since reset may have been lost or doubled on their way; empty:
  /// they were not. Cleared by this.
  virtual std::string take_damage() { return {}; }
};

}  // namespace rubric::runner
