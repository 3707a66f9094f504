#include "conformance/trace/events/lines.h"

#include <utility>

#include "conformance/trace/events/app_events.h"

namespace rubric::events {
namespace {

using machine::Link;
using trace::Line;
using trace::Message;
using trace::Op;

Line frame_line(std::int64_t now, const NodeNames& names, Op op, const machine::Frame& frame) {
  return trace::frame_line(now, names.node, op, names.link(frame.link), kind_of(frame.link),
                           frame_of(names, frame));
}

Line with_rule(Line line, ReqId rule) {
  const std::string_view text = trace::requirement_text(rule);
  if (!text.empty()) line.requirements.emplace_back(text);
  return line;
}

}  // namespace

const std::string& NodeNames::link(Link link) const {
  if (link == Link::kRadio) return radio;
  return link == Link::kSerial ? serial : peis;
}

trace::LinkKind kind_of(Link link) {
  if (link == Link::kRadio) return trace::LinkKind::kRadio;
  return link == Link::kSerial ? trace::LinkKind::kSerial : trace::LinkKind::kPeis;
}

trace::AmFrame frame_of(const NodeNames& names, const machine::Frame& frame) {
  const std::uint8_t group = frame.link == Link::kRadio ? names.radio_group : std::uint8_t{0};
  return {frame.dest,
          frame.src,
          group,
          frame.type,
          {frame.payload.begin(), frame.payload.end()},
          {frame.packet.begin(), frame.packet.end()}};
}

std::vector<std::uint8_t> packet_of(const machine::Frame& frame) {
  return trace::packet_of(frame_of({}, frame));
}

std::optional<Line> given_line(std::int64_t now, const NodeNames& names,
                               const machine::Event& event) {
  const auto line = [&](const std::string& link, Message message) {
    return trace::app_line(now, names.node, Op::kGiven, link, std::move(message));
  };
  const auto busy = [](bool is) { return Message::named(is ? "busy" : "idle"); };
  if (const auto* heard = std::get_if<machine::Heard>(&event)) {
    return frame_line(now, names, Op::kGiven, heard->frame);
  }
  if (const auto* called = std::get_if<machine::Called>(&event)) {
    return line("app", from_call(called->call));
  }
  if (const auto* done = std::get_if<machine::SendDone>(&event)) {
    const auto acked = trace::Value::of(done->acked ? 1 : 0);
    return line(names.link(done->link), Message::named("linkack").with("acked", acked));
  }
  if (const auto* one = std::get_if<machine::LinkBusy>(&event)) {
    return line(names.link(one->link), busy(one->busy));
  }
  if (const auto* app = std::get_if<machine::AppBusy>(&event)) return line("app", busy(app->busy));
  if (std::holds_alternative<machine::TimerDue>(event)) return {};
  const bool reboot = std::holds_alternative<machine::Reboot>(event);
  return line("power", Message::named(reboot ? "reboot" : "off"));
}

Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Frame& frame,
                  ReqId rule) {
  return with_rule(frame_line(now, names, Op::kEmits, frame), rule);
}

Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Notice& notice,
                  ReqId rule) {
  return with_rule(trace::app_line(now, names.node, Op::kEmits, "app", from_notice(notice)), rule);
}

std::vector<Line> emitted_lines(std::int64_t now, const NodeNames& names,
                                const machine::Actions& actions) {
  std::vector<Line> out;
  for (const machine::Action& action : actions.all()) {
    if (action.what == machine::Action::What::kTransmit) {
      const machine::Frame frame = actions.transmit_of(action).frame();
      out.push_back(emitted_line(now, names, frame, action.requirement));
    } else if (action.what == machine::Action::What::kNotify) {
      out.push_back(emitted_line(now, names, actions.notice_of(action), action.requirement));
    }
  }
  return out;
}

}  // namespace rubric::events
