// Writes the frames of a run as a pcapng capture, as a perfect sniffer and taps on the serial lines
// see them: the layout of the captures in spec/captures/firmware.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/writer.h"
#include "conformance/simulate/recorder.h"

namespace rubric::simulate {

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

}  // namespace rubric::simulate
