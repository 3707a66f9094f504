// An implementation under test on a clock that the runner turns, whatever stands behind it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/machine/step.h"

namespace rubric::runner {

using machine::Ticks;

/// Something that the implementation did: a frame on a line, or news for its application.
struct Output {
  Ticks time = 0;
  bool is_frame = false;
  machine::Transmit frame;             ///< If it is a frame.
  machine::Notice notice;              ///< Else; Received::data are in `data`.
  std::vector<std::uint8_t> data;      ///< The bytes of Received.
  ReqId requirement = ReqId::kNone;    ///< The rule that the implementation names; often none.
};

class Target {
 public:
  virtual ~Target() = default;
  virtual void reset(const machine::Config& config) = 0;
  /// An event from outside. Time does not go backwards.
  virtual void give(Ticks now, const machine::Event& event) = 0;
  /// When it will next do something on its own, if ever.
  virtual std::optional<Ticks> next() const = 0;
  /// Lets everything happen that is due up to and including `time`.
  virtual void run_until(Ticks time) = 0;
  /// All outputs since reset, in their order.
  virtual const std::vector<Output>& outputs() const = 0;
  /// While set, frames that ask for a link ack end when the runner gives SendDone, not before.
  virtual void hold_link_acks(bool hold) = 0;
};

}  // namespace rubric::runner
