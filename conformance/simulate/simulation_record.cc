// Simulation: counts events, and passes them to all recorders.
#include <variant>

#include "conformance/simulate/simulation.h"

namespace rubric::simulate {

namespace {

constexpr std::size_t kLinkAckBytes = 3;

}  // namespace

void Simulation::count(const machine::Notice& notice) {
  if (std::holds_alternative<machine::Received>(notice)) ++statistics_.received;
  if (const auto* joined = std::get_if<machine::Joined>(&notice)) {
    ++(joined->success ? statistics_.joins : statistics_.join_failures);
  }
  if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) {
    ++(ack->success ? statistics_.acks : statistics_.ack_failures);
  }
  if (const auto* data = std::get_if<machine::SynDataReceived>(&notice)) {
    switch (data->status) {
      case machine::DataStatus::kNew: ++statistics_.synaptic_new; break;
      case machine::DataStatus::kOld: ++statistics_.synaptic_old; break;
      case machine::DataStatus::kUnknownChannel: ++statistics_.synaptic_unknown; break;
    }
  }
}

void Simulation::given(Micros time_us, NodeId node, const machine::Event& event) {
  for (Recorder* recorder : recorders_) recorder->given(time_us, node, event);
}

void Simulation::did(Micros time_us, NodeId node, const machine::Actions& actions) {
  for (const machine::Notice& notice : actions.notices()) count(notice);
  for (Recorder* recorder : recorders_) recorder->did(time_us, node, actions);
}

void Simulation::mishap(Micros time_us, NodeId node, Mishap what, const machine::Frame& frame) {
  switch (what) {
    case Mishap::kLost: ++statistics_.lost; break;
    case Mishap::kCollided: ++statistics_.collided; break;
    case Mishap::kDoubled: ++statistics_.doubled; break;
    case Mishap::kUnheard: ++statistics_.unheard; break;
  }
  for (Recorder* recorder : recorders_) recorder->mishap(time_us, node, what, frame);
}

void Simulation::link_ack(Micros time_us, NodeId node, bool acked) {
  for (Recorder* recorder : recorders_) recorder->link_ack(time_us, node, acked);
}

void Simulation::on_air(Micros time_us, std::size_t radio, Bytes frame) {
  ++(frame.size() == kLinkAckBytes ? statistics_.link_acks : statistics_.radio_frames);
  for (Recorder* recorder : recorders_) recorder->on_air(time_us, radio, frame);
}

void Simulation::on_serial(Micros time_us, std::size_t line, bool to_sink,
                           const SerialFrame& frame) {
  ++statistics_.serial_frames;
  for (Recorder* recorder : recorders_) recorder->on_serial(time_us, line, to_sink, frame);
}

}  // namespace rubric::simulate
