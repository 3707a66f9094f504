// The interface through which a run is written down.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/writer.h"
#include "codec/runtime/bytes.h"
#include "conformance/machine/actions.h"
#include "conformance/simulate/network.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/trace.h"

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

// Writes the frames of a run as a pcapng capture, as a perfect sniffer and taps on the serial lines
// see them: the layout of the captures in spec/captures/firmware.

/// Interface `radio` (`radio:NAME` where there are several): 802.15.4 with FCS, stamped with the
/// frame's start. Interface `serial:1` of the first sink, `serial:101` of the second, and so on:
/// content of serial frames, stamped with their end, inbound to the sink.
class CaptureRecorder final : public Recorder {
 public:
  explicit CaptureRecorder(const Network& network);

  void on_air(Micros time_us, std::size_t radio, Bytes frame) override;
  void on_serial(Micros time_us, std::size_t line, bool to_sink, const SerialFrame& frame) override;

  /// Returns the whole file. Call once, at the end of the run.
  std::string finish();

 private:
  void write(Micros time_us, Packet& packet, std::string_view interface_name);

  std::vector<std::string> radio_names_;
  std::vector<std::string> serial_names_;
  PcapngWriter writer_;
  std::string out_;
};

/// Writes one case with all lines, at absolute ticks; every node under test. Frames that a line
/// loses, doubles, or that find their receiver off are shown as the line's faults, with the
/// receiver in a comment.
class TraceRecorder final : public Recorder {
 public:
  TraceRecorder(const Network& network, std::string_view case_name);

  void given(Micros time_us, NodeId node, const machine::Event& event) override;
  void did(Micros time_us, NodeId node, const machine::Actions& actions) override;
  void mishap(Micros time_us, NodeId node, Mishap what, const machine::Frame& frame) override;
  void link_ack(Micros time_us, NodeId node, bool acked) override;

  const trace::File& file() const { return file_; }

 private:
  void add(trace::Line line) { file_.cases.front().add(std::move(line)); }

  std::vector<events::NodeNames> names_;
  trace::File file_;
};

}  // namespace rubric::simulate
