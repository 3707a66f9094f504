#include "conformance/check/judge/interface_watch.h"

namespace rubric::check {
namespace {

using machine::Link;

}  // namespace

InterfaceWatch::Node& InterfaceWatch::look(std::uint16_t device) {
  Node& node = nodes_[device];
  if (!node.begun && context_.options.start_cold) {
    for (Interface& interface : node.interfaces) interface.on = true;
  }
  node.begun = true;
  return node;
}

InterfaceWatch::Interface* InterfaceWatch::find(Node& node, Link link) {
  return link == Link::kPeis ? nullptr : &node.interfaces[link == Link::kRadio ? 0 : 1];
}

void InterfaceWatch::begin_life(std::uint16_t device) {
  Node& node = nodes_[device] = Node{};
  for (Interface& interface : node.interfaces) interface.on = true;  // A node boots with both on.
  node.begun = true;
}

void InterfaceWatch::called(std::uint16_t device, const Observation& seen) {
  Node& node = look(device);
  if (std::holds_alternative<machine::Send>(*seen.call)) {
    // A mote's messages all leave by radio.
    const Interface& radio = node.interfaces[0];
    node.sends = context_.device(device).role == machine::Role::kMote && radio.again;
    node.left.reset();
    node.sends_off = switched_off(device, Link::kRadio);
    node.off_next.reset();
    return;
  }
  if (const auto* const get = std::get_if<machine::GetInterface>(seen.call)) {
    Interface* const interface = find(node, get->link);
    if (interface == nullptr) return;
    judge_untold(device, *interface, seen.place.time_us);
    interface->asked = seen.place;
    return;
  }
  const auto* const set = std::get_if<machine::SetInterface>(seen.call);
  Interface* const interface = set == nullptr ? nullptr : find(node, set->link);
  if (interface == nullptr) return;
  const bool off = interface->on.has_value() && !*interface->on;
  if (interface->on != set->on) interface->changed_us = seen.place.time_us;
  interface->on = set->on;
  interface->again = set->on && (off || interface->again);
  if (!set->on) node.awaited.reset();
}

void InterfaceWatch::told(std::uint16_t device, const Observation& seen) {
  Node& node = look(device);
  if (const auto* result = std::get_if<machine::SendResult>(seen.notice)) {
    if (node.sends_off && node.left == result->seq_num) {
      judge_off(device, seen, node, result->seq_num);
    } else if (node.sends_off && result->seq_num != machine::kNoSeq) {
      node.off_next = result->seq_num;
    }
    if (node.sends && node.left == result->seq_num) {  // It left before the call returned.
      node.interfaces[0].again = false;
      context_.findings.kept("N10-ON"_rule);
    } else if (node.sends && result->seq_num != machine::kNoSeq && !node.awaited) {
      node.awaited = result->seq_num;
      node.accepted = seen.place;
    }
    node.sends = false;
    return;
  }
  const auto* const state = std::get_if<machine::InterfaceState>(seen.notice);
  Interface* const interface = state == nullptr ? nullptr : find(node, state->link);
  if (interface == nullptr) return;
  interface->asked.reset();
  if (!interface->on) return;
  if (state->on == *interface->on) return context_.findings.kept("N10-STATE"_rule);
  const std::string what = state->link == Link::kRadio ? "radio" : "serial interface";
  context_.report("N10-STATE"_rule, Severity::kFail, seen.place, device,
                  {"The " + what + " is said to be " + (state->on ? "on" : "off") + ", " +
                       ms_text(seen.place.time_us - interface->changed_us) +
                       " after it was switched " + (*interface->on ? "on." : "off."),
                   std::string("That it is ") + (*interface->on ? "on." : "off."),
                   {}});
}

bool InterfaceWatch::off(std::uint16_t device, Link link, std::int64_t now_us) const {
  if (link == Link::kPeis) return false;
  const Interface& interface = nodes_[device].interfaces[link == Link::kRadio ? 0 : 1];
  return interface.on.has_value() && !*interface.on &&
         now_us - interface.changed_us > context_.early_us(device);
}

bool InterfaceWatch::switched_off(std::uint16_t device, Link link) const {
  if (link == Link::kPeis || device == kNobody) return false;
  const Interface& interface = nodes_[device].interfaces[link == Link::kRadio ? 0 : 1];
  return interface.on.has_value() && !*interface.on;
}

std::int64_t InterfaceWatch::on_since(std::uint16_t device, Link link) const {
  if (link == Link::kPeis) return 0;
  const Interface& interface = nodes_[device].interfaces[link == Link::kRadio ? 0 : 1];
  return !switched_off(device, link) ? interface.changed_us : -1;
}

//= N2-BUSY: While a line is busy nothing is sent on it.
void InterfaceWatch::sent(std::uint16_t device, const Observation& seen) {
  const std::int64_t now = seen.place.time_us;
  const bool taken = std::ranges::any_of(context_.busy_times(device), [&](const BusyTime& busy) {
    return busy.line == seen.frame.link && busy.from_us < now && now < busy.to_us;
  });
  if (taken && context_.run.has_time) {
    context_.report("N2-BUSY"_rule, Severity::kFail, seen.place, device,
                    {"A frame leaves while somebody else has the line, by the node's log.",
                     "It waits until the line is free.",
                     {}});
  }
  // Frames on their way when the interface was switched off may still arrive.
  if (!context_.run.has_time || !off(device, seen.frame.link, seen.place.time_us)) return;
  context_.report("N10-OFF"_rule, Severity::kFail, seen.place, device,
                  {std::string("A frame leaves through the ") +
                       (seen.frame.link == Link::kRadio ? "radio" : "serial interface") +
                       ", which is switched off.",
                   "Silence.",
                   {}});
}

// Says that the radio sends what send was called for while it was off: that was not on its way.
void InterfaceWatch::judge_off(std::uint16_t device, const Observation& seen, Node& node,
                               std::uint16_t seq_num) {
  node.sends_off = false;
  node.off_next.reset();
  context_.report("N10-OFF"_rule, Severity::kFail, seen.place, device,
                  {"The message with number " + number(seq_num) +
                       " leaves by radio, which was off when send was called.",
                   "Silence until the radio is on.",
                   {}});
}

void InterfaceWatch::own_message(std::uint16_t device, const Observation& seen,
                                 std::uint16_t seq_num) {
  Node& node = nodes_[device];
  const bool off = seen.frame.link == Link::kRadio && switched_off(device, Link::kRadio);
  if (off && node.off_next == seq_num) judge_off(device, seen, node, seq_num);
  if (off || node.sends) node.left = seq_num;
  if (node.awaited != seq_num) return;
  node.awaited.reset();
  node.interfaces[0].again = false;
  context_.findings.kept("N10-ON"_rule);
}

// Reports a question for the state that has had no answer until `now_us`.
void InterfaceWatch::judge_untold(std::uint16_t device, const Interface& interface,
                                  std::int64_t now_us) {
  // Only a whole log surely has the answer.
  if (!interface.asked || !context_.device(device).whole || !context_.run.has_time) return;
  if (now_us <= context_.due_us(device, interface.asked->time_us)) return;
  context_.report("N10-STATE"_rule, Severity::kFail, *interface.asked, device,
                  {"The application asked whether an interface is on, and was told nothing.",
                   "Its state.",
                   {}});
}

void InterfaceWatch::finish() {
  if (!context_.run.has_time) return;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto device = static_cast<std::uint16_t>(i);
    const Node& node = nodes_[i];
    const std::int64_t end_us = context_.end_us(device);
    for (const Interface& interface : node.interfaces) judge_untold(device, interface, end_us);
    const bool busy = !context_.busy_times(device).empty();
    if (!node.awaited || busy || end_us - node.accepted.time_us <= context_.response_us(device))
      continue;
    const Severity severity = context_.device(device).hearing
                                  ? Severity::kFail
                                  : context_.without(device, node.accepted.time_us, end_us);
    context_.report("N10-ON"_rule, severity, node.accepted, device,
                    {"The radio was switched on again, send accepted the message " +
                         number(*node.awaited) + ", and it never left.",
                     "It sends again.",
                     {}});
  }
}

}  // namespace rubric::check
