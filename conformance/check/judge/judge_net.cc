// Messages on their way: who sends, passes on and receives them.
#include "conformance/check/judge/judge_pass.h"
#include "conformance/check/links.h"
#include "conformance/machine/transport.h"

namespace rubric::check {

using machine::Role;
using Kind = Observation::Kind;

// Takes the link's own repetition, or a log's line that shows who received a frame.
void Judge::repeated(std::uint32_t index, const Observation& seen, const Mark& mark) {
  if (seen.kind == Kind::kRadio) joins_heard(index, seen, mark);
  Net net;
  if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
  if (mark.receiver != kNobody) return surely(seen, mark, net);
  const bool serial = seen.kind == Kind::kSerial;
  if (serial && mark.device == kNobody) return;
  forwarding_.repeated(net, serial ? who_.devices[mark.device].partner : kNobody);
  context_.for_motes(seen.frame.dest, [&](std::uint16_t mote) { acks_.repeated(mote, net); });
  for (const std::uint16_t sink : context_.sinks) acks_.repeated(sink, net);
}

// Takes a log's line that gives a node a message that is known from its sender.
void Judge::surely(const Observation& seen, const Mark& mark, const Net& net) {
  if (interfaces_.switched_off(mark.receiver, seen.frame.link)) return;
  acks_.surely(mark.receiver, net);
  if (seen.kind == Kind::kRadio) synaptic_.given(mark.receiver, seen, net);
  if (net.is_ack()) originals_.ack_given(mark.receiver, net, seen.place.time_us);
  if (seen.kind == Kind::kRadio) {
    forwarding_.heard_on_radio(seen, mark.device, net, mark.receiver);
  }
  if (mark.again) acks_.repeated(mark.receiver, net);
  if (seen.kind == Kind::kSerial) peis_.surely_up(mark.receiver, net);
}

void Judge::radio_net(std::uint32_t index, const Observation& seen, const Mark& mark,
                      const Net& net) {
  const std::uint16_t sender = mark.device;
  if (is(sender, Role::kMote)) {
    motes_.net_msg(sender, seen, net);
    own_message(sender, seen, net, machine::Link::kRadio, motes_.address(sender).value_or(net.src));
  } else if (is(sender, Role::kSink)) {
    const Device& sink = who_.devices[sender];
    // A base station may hand its sink even the sink's own message (decision 126).
    const bool own = net.src == machine::Address{sinks_.island(sender), sink.am};
    if (own && !forwarding_.came_down(sender, net)) {
      own_message(sender, seen, net, machine::Link::kRadio, net.src);
    } else {
      acks_.showed_life(sender, seen.place.time_us);
      const bool known = forwarding_.sent_on_radio(sender, seen, net);
      if (!known && !net.sound) originals_.judge_content(sender, seen, net);
    }
  }
  if (sender == kNobody && seen.frame.src == context_.sink_am) forwarding_.somebody_sent(net);
  const std::uint16_t sure = sure_sink(index);
  forwarding_.heard_on_radio(seen, sender, net, sure);
  const auto hear = [&](std::uint16_t mote) {
    if (mote != sender) mote_hears(mote, seen, mark, net);
  };
  if (seen.frame.dest == machine::kAmBroadcast) {
    for (std::size_t i = 0; i < who_.devices.size(); ++i) {
      const auto node = static_cast<std::uint16_t>(i);
      if (is(node, Role::kMote)) hear(node);
    }
  } else {
    context_.for_motes(seen.frame.dest, hear);
  }
  for (const std::uint16_t sink : context_.sinks) {
    const std::uint16_t am = who_.devices[sink].am;
    if (sink == sender) continue;
    if (seen.frame.dest != am && seen.frame.dest != machine::kAmBroadcast) continue;
    hears(sink, {Role::kSink, {sinks_.island(sink), am}, true, context_.sink_am},
          machine::Link::kRadio, seen, sender, net, sure == sink || mark.receiver == sink);
  }
  if (net.is_ack()) ack_comes(net);
  if (net.is_ack() && mark.receiver != kNobody) {
    originals_.ack_given(mark.receiver, net, seen.place.time_us);
  }
}

// Takes a message of the node's own.
void Judge::own_message(std::uint16_t node, const Observation& seen, const Net& net,
                        machine::Link link, machine::Address own) {
  acks_.showed_life(node, seen.place.time_us);
  interfaces_.own_message(node, net.seq_num);
  originals_.sent(node, seen, net, link, own);
  if (net.is_ack()) acks_.sent(node, seen, net);
  if (net.sound && net.trans_id == component::kSynChannel) synaptic_.sent(node, seen, net);
}

void Judge::mote_hears(std::uint16_t mote, const Observation& seen, const Mark& mark,
                       const Net& net) {
  const std::uint16_t am = who_.devices[mote].am;
  const std::optional<machine::Address> own = motes_.address(mote);
  // If its island is uncertain, anything for its devid may be for it.
  const machine::Address presumed = own.value_or(machine::Address{net.dest.pid, am});
  hears(mote, {Role::kMote, presumed, true, context_.sink_am}, machine::Link::kRadio, seen,
        mark.device, net, mark.receiver == mote);
}

void Judge::hears(std::uint16_t node, const machine::Router& router, machine::Link from,
                  const Observation& seen, std::uint16_t sender, const Net& net, bool sure) {
  if (router.own.pid == 0) return;  // A sink of which no island is known.
  const machine::Route route = machine::route_received(router, from, net.dest, net.src);
  if (!route.deliver && route.onward != machine::Route::Onward::kNowhere) return;
  // A message to every island may be taken or ignored (decision 114).
  const bool free = route.deliver || net.dest.pid == machine::kBroadcastPid;
  const bool off = interfaces_.off(node, from, seen.place.time_us);
  const ReqId forbidden = off ? "N10-OFF"_rule : free ? ReqId::kNone : route.requirement;
  // So may one straight from a foreign mote (decision 116), and one for another island that a base
  // station sends down to its sink (decision 126).
  const bool radio = from == machine::Link::kRadio;
  const bool straight = net.dest.pid != router.own.pid ||
                        (radio && net.src.pid != net.dest.pid && !is(sender, Role::kSink));
  acks_.arrived(node, seen, sender, net,
                {forbidden, forbidden == "N6-OTHER"_rule,
                 sure && !interfaces_.switched_off(node, from), straight});
  if (sure && !off && route.deliver) synaptic_.given(node, seen, net);
}

// Counts an ack at the originator of the acked message.
void Judge::ack_comes(const Net& ack) {
  const std::int32_t acked = machine::acked_seq_num(ack.body());
  if (acked < 0) return;
  const auto seq_num = static_cast<std::uint16_t>(acked);
  context_.for_motes(ack.dest.devid,
                     [&](std::uint16_t mote) { originals_.ack_heard(mote, ack, seq_num); });
  for (const std::uint16_t sink : context_.sinks) {
    const Device& device = who_.devices[sink];
    if (sinks_.island(sink) != ack.dest.pid) continue;
    if (ack.dest.devid == device.am) originals_.ack_heard(sink, ack, seq_num);
    if (ack.dest.devid == machine::kNullDevid && device.partner != kNobody) {
      originals_.ack_heard(device.partner, ack, seq_num);
    }
  }
}

void Judge::serial(std::uint32_t index, const Observation& seen, const Mark& mark) {
  const std::uint16_t sink = seen.to_mote ? who_.devices[mark.device].partner : mark.device;
  if (sink == kNobody) {  // Nothing is known of the sink, as in a part of a run.
    Net net;
    const bool handed = seen.to_mote && !seen.received && seen.frame.type == am::kNet;
    const machine::Address base{who_.devices[mark.device].island, machine::kNullDevid};
    if (handed && parse_net(seen.frame.payload, net) && net.src != base) {
      peis_.went_down(mark.device, seen, net);
    }
    return;
  }
  if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
    if (interfaces_.switched_off(sink, machine::Link::kSerial)) return;  // It hears nothing.
    const auto island = static_cast<std::uint16_t>(id);
    const bool sure = serial_acked(run_, index) || mark.receiver == sink;
    sinks_.set_island(sink, island, seen.place, sure);
    forwarding_.set_island(sink, island, seen.place.time_us, sure);
    return;
  }
  if (!seen.to_mote) sinks_.showed_life(mark.device, seen.place.time_us, true);
  Net net;
  if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
  if (!seen.received) whole(seen, mark.device);
  if (seen.to_mote) {
    down_serial(index, seen, mark, sink, net);
  } else {
    up_serial(seen, sink, net);
  }
  if (net.is_ack()) ack_comes(net);
}

void Judge::whole(const Observation& seen, std::uint16_t sender) {
  constexpr std::size_t kWhole = rubicon::NetMsgView::kMaxSizeBytes;
  const std::size_t size = seen.frame.payload.size();
  if (size >= kWhole || !cut_short_.insert(sender).second) return;
  context_.report("N11-WHOLE"_rule, Severity::kWeak, seen.place, sender,
                  {"A net_msg of " + number(size) + " bytes on the serial line.",
                   number(kWhole) + " bytes; hosts of release 1.0 drop what is shorter.",
                   {}});
}

void Judge::up_serial(const Observation& seen, std::uint16_t sink, const Net& net) {
  const Device& device = who_.devices[sink];
  SerialJoined joined;
  if (parse_serial_joined(net, joined)) {
    sinks_.report(sink, seen, net, joined);
    return base_station_hears(sink, seen, net);
  }
  acks_.showed_life(sink, seen.place.time_us);
  const std::uint16_t island = sinks_.island(sink);
  if (net.src == machine::Address{island, device.am}) {
    own_message(sink, seen, net, machine::Link::kSerial, net.src);
  } else {
    forwarding_.sent_on_serial(sink, seen, net);
  }
  base_station_hears(sink, seen, net);
}

void Judge::base_station_hears(std::uint16_t sink, const Observation& seen, const Net& net) {
  const std::uint16_t base = who_.devices[sink].partner;
  if (base == kNobody) return;
  peis_.came_up(base, sinks_.island(sink), seen, net, seen.received);
  hears(base,
        {Role::kBaseStation, {sinks_.island(sink), machine::kNullDevid}, true, context_.sink_am},
        machine::Link::kSerial, seen, sink, net, false);
}

void Judge::down_serial(std::uint32_t index, const Observation& seen, const Mark& mark,
                        std::uint16_t sink, const Net& net) {
  const std::uint16_t island = sinks_.island(sink);
  const machine::Address base{island, machine::kNullDevid};
  if (net.src == base) own_message(mark.device, seen, net, machine::Link::kSerial, base);
  if (net.src != base && !seen.received) peis_.went_down(mark.device, seen, net);
  const bool deaf = interfaces_.switched_off(sink, machine::Link::kSerial) ||
                    interfaces_.switched_off(sink, machine::Link::kRadio);
  const bool sure = !deaf && (serial_acked(run_, index) || mark.receiver == sink);
  forwarding_.heard_on_serial(sink, mark.device, seen, net, sure);
  const std::uint16_t am = who_.devices[sink].am;
  if (net.dest.devid != am && net.dest.devid != machine::kBroadcastDevid) return;
  hears(sink, {Role::kSink, {island, am}, true, context_.sink_am}, machine::Link::kSerial, seen,
        mark.device, net, sure);
}

// Takes a message between base stations, by the log of `base`.
void Judge::peis(const Observation& seen, std::uint16_t base) {
  Net net;
  if (!is(base, Role::kBaseStation) || seen.frame.type != am::kNet) return;
  if (!parse_net(seen.frame.payload, net)) return;
  const Device& device = who_.devices[base];
  const std::uint16_t island =
      device.partner == kNobody ? device.island : sinks_.island(device.partner);
  const machine::Address own{island, machine::kNullDevid};
  if (!seen.received) {
    const bool at_home = peis_.sent(base, seen, net, own);
    if (at_home && net.src == own) own_message(base, seen, net, machine::Link::kPeis, own);
    return;
  }
  peis_.given(base, seen, net, own);
  hears(base, {Role::kBaseStation, own, true, context_.sink_am}, machine::Link::kPeis, seen,
        kNobody, net, true);
  const std::int32_t acked = net.is_ack() ? machine::acked_seq_num(net.body()) : -1;
  if (acked < 0 || net.dest != own) return;
  originals_.ack_heard(base, net, static_cast<std::uint16_t>(acked));
  originals_.ack_given(base, net, seen.place.time_us);
}

}  // namespace rubric::check
