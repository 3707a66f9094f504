// Writes a run as a .rtr log: each node's inputs and outputs, with their rules.
#pragma once

#include <string>
#include <string_view>

#include "conformance/simulate/recorder.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/trace.h"

namespace rubric::simulate {

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
