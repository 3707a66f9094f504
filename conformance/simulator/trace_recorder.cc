#include "conformance/simulator/trace_recorder.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "conformance/events/app_events.h"
#include "conformance/simulator/radio.h"
#include "conformance/trace/concrete.h"

namespace rubric::simulator {
namespace {

using machine::Action;
using machine::Link;
using trace::LinkKind;
using trace::Message;
using trace::Op;

constexpr std::string_view kPeis = "peis";
constexpr std::string_view kApp = "app";
constexpr std::string_view kPower = "power";

trace::AmFrame frame_of(const machine::Frame& frame) {
  trace::AmFrame out;
  out.dest = frame.dest;
  out.src = frame.src;
  if (frame.link == Link::kRadio) out.group = static_cast<std::uint8_t>(kPanId);
  out.type = frame.type;
  out.payload.assign(frame.payload.begin(), frame.payload.end());
  return out;
}

LinkKind kind_of(Link link) {
  switch (link) {
    case Link::kRadio: return LinkKind::kRadio;
    case Link::kSerial: return LinkKind::kSerial;
    case Link::kPeis: break;
  }
  return LinkKind::kPeis;
}

trace::Role role_of(machine::Role role) {
  switch (role) {
    case machine::Role::kMote: return trace::Role::kMote;
    case machine::Role::kSink: return trace::Role::kSink;
    case machine::Role::kBaseStation: break;
  }
  return trace::Role::kBaseStation;
}

std::string_view text_of(Mishap what) {
  switch (what) {
    case Mishap::kLost: return "lost";
    case Mishap::kCollided: return "collision";
    case Mishap::kDoubled: return "twice";
    case Mishap::kUnheard: break;
  }
  return "off";
}

trace::Header header_of(const NodePlan& plan) {
  trace::NodeHeader node;
  node.name = plan.name;
  node.role = role_of(plan.config.role);
  if (plan.config.role != machine::Role::kBaseStation) node.id = plan.config.id;
  if (plan.config.role != machine::Role::kMote) node.island = plan.config.island;
  if (plan.config.profile.channels_max != machine::Profile{}.channels_max) {
    node.channels = plan.config.profile.channels_max;
  }
  node.iut = true;
  trace::Header header;
  header.what = node;
  return header;
}

trace::Header header_of(std::string_view name, LinkKind kind, std::vector<std::string> nodes) {
  trace::Header header;
  header.what = trace::LinkHeader{std::string(name), kind, std::move(nodes)};
  return header;
}

}  // namespace

TraceRecorder::TraceRecorder(const Network& network, std::string_view case_name)
    : names_(network.nodes.size()), file_(trace::File::begin(network.profile)) {
  trace::Header seed;
  seed.what = trace::SeedHeader{network.seed};
  file_.header(std::move(seed));
  for (NodeId i = 0; i < names_.size(); ++i) {
    names_[i].node = network.nodes[i].name;
    file_.header(header_of(network.nodes[i]));
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
    file_.header(header_of(kPeis, LinkKind::kPeis, std::move(base_stations)));
  }
  file_.cases.emplace_back(case_name);
}

std::string_view TraceRecorder::link_name(NodeId node, Link link) const {
  if (link == Link::kRadio) return names_[node].radio;
  return link == Link::kSerial ? std::string_view(names_[node].serial) : kPeis;
}

void TraceRecorder::given(Micros time_us, NodeId node, const machine::Event& event) {
  const std::int64_t ticks = ticks_of(time_us);
  if (const auto* heard = std::get_if<machine::Heard>(&event)) {
    const Link link = heard->frame.link;
    add(trace::frame_line(ticks, names_[node].node, Op::kGiven, link_name(node, link),
                          kind_of(link), frame_of(heard->frame)));
  } else if (const auto* called = std::get_if<machine::Called>(&event)) {
    trace::Message call = events::from_call(called->call);
    add(trace::app_line(ticks, names_[node].node, Op::kGiven, kApp, std::move(call)));
  } else if (std::holds_alternative<machine::Reboot>(event)) {
    add(trace::app_line(ticks, names_[node].node, Op::kGiven, kPower, Message::named("reboot")));
  } else if (std::holds_alternative<machine::PowerOff>(event)) {
    add(trace::app_line(ticks, names_[node].node, Op::kGiven, kPower, Message::named("off")));
  }
}

void TraceRecorder::did(Micros time_us, NodeId node, const machine::Actions& actions) {
  const std::int64_t ticks = ticks_of(time_us);
  for (const Action& action : actions.all()) {
    trace::Line line;
    if (action.what == Action::What::kTransmit) {
      const machine::Frame frame = actions.transmit_of(action).frame();
      line = trace::frame_line(ticks, names_[node].node, Op::kEmits, link_name(node, frame.link),
                               kind_of(frame.link), frame_of(frame));
    } else if (action.what == Action::What::kNotify) {
      line = trace::app_line(ticks, names_[node].node, Op::kEmits, kApp,
                             events::from_notice(actions.notice_of(action)));
    } else {
      continue;
    }
    const std::string_view rule = trace::requirement_text(action.requirement);
    if (!rule.empty()) line.requirements.emplace_back(rule);
    add(std::move(line));
  }
}

void TraceRecorder::mishap(Micros time_us, NodeId node, Mishap what, const machine::Frame& frame) {
  trace::Line line =
      trace::fault_line(ticks_of(time_us), what == Mishap::kDoubled ? Op::kDup : Op::kLost,
                        link_name(node, frame.link), kind_of(frame.link), frame_of(frame));
  line.comment = names_[node].node + ": " + std::string(text_of(what));
  add(std::move(line));
}

void TraceRecorder::link_ack(Micros time_us, NodeId node, bool acked) {
  add(trace::app_line(
      ticks_of(time_us), names_[node].node, Op::kGiven, names_[node].radio,
      Message::named("linkack").with("acked", trace::Value::of(acked ? 1 : 0))));
}

}  // namespace rubric::simulator
