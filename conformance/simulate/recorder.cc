#include "conformance/simulate/recorder.h"

#include <utility>
#include <variant>

#include "codec/containers/link_record.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/hdlc.h"
#include "codec/runtime/ieee802154_fcs.h"
#include "conformance/simulate/radio.h"
#include "conformance/trace/concrete.h"

namespace rubric::simulate {
namespace {

using trace::LinkKind;
using trace::Op;

std::string_view text_of(Mishap what) {
  switch (what) {
    case Mishap::kLost: return "lost";
    case Mishap::kCollided: return "collision";
    case Mishap::kDoubled: return "twice";
    case Mishap::kUnheard: break;
  }
  return "off";
}

trace::NodeHeader header_of(const NodePlan& plan) {
  trace::NodeHeader node = events::header_of(plan.config, plan.name);
  if (plan.config.profile.channels_max != machine::Profile{}.channels_max) {
    node.stated.push_back({trace::ParameterId::kChannels, plan.config.profile.channels_max});
  }
  return node;
}

trace::Header header_of(std::string_view name, LinkKind kind, std::vector<std::string> nodes) {
  return {trace::LinkHeader{std::string(name), kind, std::move(nodes)}, {}, {}};
}

constexpr std::int64_t kNsPerUs = 1'000;

}  // namespace

TraceRecorder::TraceRecorder(const Network& network, std::string_view case_name)
    : names_(network.nodes.size()), file_(trace::File::begin(network.profile)) {
  file_.header({trace::SeedHeader{network.seed}, {}, {}});
  for (NodeId i = 0; i < names_.size(); ++i) {
    names_[i].node = network.nodes[i].name;
    names_[i].radio_group = static_cast<std::uint8_t>(kPanId);
    file_.node(header_of(network.nodes[i]));
  }
  const auto is_mote_or_sink = [&](NodeId i) {
    return network.nodes[i].config.role != machine::Role::kBaseStation;
  };
  for (std::size_t radio = 0; radio < network.radios.size(); ++radio) {
    std::vector<std::string> nodes;
    for (NodeId i = 0; i < names_.size(); ++i) {
      if (!is_mote_or_sink(i) || network.nodes[i].radio != radio) continue;
      names_[i].radio = network.radios[radio].name;
      nodes.push_back(names_[i].node);
    }
    file_.header(header_of(network.radios[radio].name, LinkKind::kRadio, std::move(nodes)));
  }
  for (const SerialPlan& line : network.serials) {
    names_[line.sink].serial = names_[line.base_station].serial = line.name;
    file_.header(header_of(line.name, LinkKind::kSerial,
                           {names_[line.sink].node, names_[line.base_station].node}));
  }
  std::vector<std::string> base_stations;
  for (NodeId i = 0; i < names_.size(); ++i) {
    if (!is_mote_or_sink(i)) base_stations.push_back(names_[i].node);
  }
  if (base_stations.size() > 1) {
    file_.header(header_of("peis", LinkKind::kPeis, std::move(base_stations)));
  }
  file_.cases.emplace_back(case_name);
}

void TraceRecorder::given(Micros time_us, NodeId node, const machine::Event& event) {
  // The ends of frames and the busy lines are the simulator's own; see link_ack.
  if (std::holds_alternative<machine::SendDone>(event) ||
      std::holds_alternative<machine::LinkBusy>(event) ||
      std::holds_alternative<machine::AppBusy>(event)) {
    return;
  }
  auto line = events::given_line(ticks_of(time_us), names_[node], event);
  if (line) add(std::move(*line));
}

void TraceRecorder::did(Micros time_us, NodeId node, const machine::Actions& actions) {
  for (trace::Line& line : events::emitted_lines(ticks_of(time_us), names_[node], actions)) {
    add(std::move(line));
  }
}

void TraceRecorder::mishap(Micros time_us, NodeId node, Mishap what, const machine::Frame& frame) {
  const events::NodeNames& names = names_[node];
  trace::Line line = trace::fault_line(
      ticks_of(time_us), what == Mishap::kDoubled ? Op::kDup : Op::kLost, names.link(frame.link),
      events::kind_of(frame.link), events::frame_of(names, frame));
  line.comment = names.node + ": " + std::string(text_of(what));
  add(std::move(line));
}

void TraceRecorder::link_ack(Micros time_us, NodeId node, bool acked) {
  const machine::SendDone done{machine::Link::kRadio, acked};
  add(*events::given_line(ticks_of(time_us), names_[node], done));
}

CaptureRecorder::CaptureRecorder(const Network& network) {
  for (const RadioPlan& radio : network.radios) {
    radio_names_.push_back(network.radios.size() == 1 ? "radio" : "radio:" + radio.name);
  }
  // Every sink has the TinyOS id 1, so the id cannot tell them apart.
  for (std::size_t i = 0; i < network.serials.size(); ++i) {
    const machine::Config& sink = network.nodes.at(network.serials[i].sink).config;
    serial_names_.push_back("serial:" + std::to_string(100 * i + sink.id));
  }
  writer_.begin(out_);
}

void CaptureRecorder::write(Micros time_us, Packet& packet, std::string_view interface_name) {
  packet.time_ns = time_us * kNsPerUs;
  writer_.write(packet, interface_name, out_);
}

void CaptureRecorder::on_air(Micros time_us, std::size_t radio, Bytes frame) {
  Packet packet{
      .framing = Framing::kRadio, .bytes = frame, .link_type = kLinkRadioFcs, .fcs = fcs(frame)};
  write(time_us, packet, radio_names_.at(radio));
}

void CaptureRecorder::on_serial(Micros time_us, std::size_t line, bool to_sink,
                                const SerialFrame& frame) {
  Packet packet{.framing = Framing::kHdlc,
                .direction = to_sink ? Direction::kInbound : Direction::kOutbound,
                .link_type = kLinkSerial,
                .kind = frame.kind,
                .serial_seq = frame.seq};
  std::uint16_t crc = crc16_step(0, frame.kind);
  if (frame.seq >= 0) crc = crc16_step(crc, static_cast<std::uint8_t>(frame.seq));
  packet.crc = crc16(frame.packet, crc);
  packet.bytes = frame.packet;
  write(time_us, packet, serial_names_.at(line));
}

std::string CaptureRecorder::finish() {
  writer_.finish(out_);
  return std::move(out_);
}

}  // namespace rubric::simulate
