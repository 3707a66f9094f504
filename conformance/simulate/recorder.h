// The interface through which a run is written down.
#pragma once

#include <cstdint>

#include "codec/runtime/bytes.h"
#include "conformance/machine/actions.h"
#include "conformance/simulate/network.h"

namespace rubric::simulate {

/// The fate of a frame on its way to a node.
enum class Mishap : std::uint8_t {
  kLost,      ///< By chance.
  kCollided,  ///< Another frame was in the air at the receiver, or the receiver was sending.
  kDoubled,
  kUnheard,  ///< The receiver's interface or power was off.
};

/// A frame of a serial line, framed but for flags and escapes.
struct SerialFrame {
  std::uint8_t kind = 0;
  std::int32_t seq = -1;  ///< Serial sequence number; -1: this kind has none.
  Bytes packet;           ///< From the dispatch byte on; empty in an ACK.
};

class Recorder {
 public:
  virtual ~Recorder() = default;
  /// Called before node steps: Heard, Called, Reboot, PowerOff. (Timers and SendDone are internal.)
  virtual void given(Micros, NodeId, const machine::Event&) {}
  /// Called after it stepped.
  virtual void did(Micros, NodeId, const machine::Actions&) {}
  virtual void mishap(Micros, NodeId /*receiver*/, Mishap, const machine::Frame&) {}
  /// Called at the end of an awaited link acknowledgement: it came, or it did not.
  virtual void link_ack(Micros, NodeId, bool /*acked*/) {}
  /// Called when an 802.15.4 frame begins; without FCS. `radio` is an index into Network::radios.
  virtual void on_air(Micros, std::size_t /*radio*/, Bytes /*frame*/) {}
  /// Called when a serial frame ends. `line` is an index into Network::serials.
  virtual void on_serial(Micros, std::size_t /*line*/, bool /*to_sink*/, const SerialFrame&) {}
};

}  // namespace rubric::simulate
