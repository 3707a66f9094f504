#include "conformance/machine/route.h"

namespace rubric::machine {
namespace {

using Onward = Route::Onward;

Route nowhere(ReqId requirement) { return {false, Onward::kNowhere, 0, requirement, ReqId::kNone}; }
Route onward(Onward line, std::uint16_t am_dest, ReqId requirement) {
  return {false, line, am_dest, requirement, ReqId::kNone};
}
Route deliver(ReqId requirement) { return {true, Onward::kNowhere, 0, ReqId::kNone, requirement}; }

bool for_own_island(const Router& router, Address dest) {
  return dest.pid == router.own.pid || dest.pid == kBroadcastPid;
}
bool for_own_device(const Router& router, Address dest) {
  return dest.devid == router.own.devid || dest.devid == kBroadcastDevid;
}

Route mote_from_radio(const Router& router, Address dest) {
  //= J11-HEAR: A mote that is not a member ignores the net_msg that it hears.
  if (!router.member) return nowhere("J11-HEAR"_rule);
  //= N5-FOREIGN: A mote ignores a net_msg whose dest.pid is another island; 0xFFFF, every island,
  //= may be delivered or ignored.
  if (!for_own_island(router, dest)) return nowhere("N5-FOREIGN"_rule);
  //= N5-OTHER: A mote ignores a net_msg of its own island whose devid is another mote or NULL.
  if (!for_own_device(router, dest)) return nowhere("N5-OTHER"_rule);
  return deliver("N5-DELIVER"_rule);
}

Route sink_from_radio(const Router& router, Address dest, Address src) {
  if (for_own_island(router, dest)) {
    if (for_own_device(router, dest)) return deliver("N6-DELIVER"_rule);
    if (dest.devid == kNullDevid && dest.pid == router.own.pid) {
      return onward(Onward::kSerial, kAmBroadcast, "N6-FORWARD"_rule);
    }
    //= N6-OTHER: A sink does not deliver a net_msg of its island for another mote to its own
    //= application; sending it on once by radio is allowed.
    return nowhere("N6-OTHER"_rule);
  }
  //= N6-COLLISION: A sink ignores a net_msg from the radio whose dest.pid and src.pid are both
  //= foreign.
  if (src.pid != router.own.pid) return nowhere("N6-COLLISION"_rule);
  return onward(Onward::kSerial, kAmBroadcast, "N6-ROUTE"_rule);
}

Route sink_from_serial(const Router& router, Address dest) {
  const bool here = for_own_island(router, dest);
  //= N6-ONCE: A sink forwards each received message once, and sends none that came by serial back
  //= over serial.
  // A message of its base station for its base station has come the wrong way.
  if (here && dest.devid == kNullDevid) return nowhere("N6-ONCE"_rule);
  Route route;
  //= N7-FOREIGN: A sink does not send a net_msg from serial for another island on the radio.
  if (!here) route.requirement = "N7-FOREIGN"_rule;
  if (for_own_device(router, dest)) {
    // The rule uses the devid alone: a base station is trusted with the island.
    route.deliver = true;
    route.delivered = "N7-DELIVER"_rule;
  }
  if (here && dest.devid != router.own.devid) {
    route.onward = Onward::kRadio;
    route.am_dest = dest.devid;  // The broadcast devid is the broadcast AM address.
    route.requirement = "N7-RADIO"_rule;
  }
  return route;
}

Route base_station_received(const Router& router, Link from, Address dest) {
  const bool from_sink = from == Link::kSerial;
  if (!for_own_island(router, dest)) {
    //= N8-LOOP: A base station does not hand a message for another island to its own sink.
    if (!from_sink) return nowhere("N8-LOOP"_rule);  // Nor back to PEIS.
    return onward(Onward::kPeis, dest.pid, "N8-PEIS"_rule);
  }
  Route route;
  if (for_own_device(router, dest)) {
    route.deliver = true;
    route.delivered = "N8-DELIVER"_rule;
  }
  if (dest.devid == kNullDevid) return route;
  // Sent back it would circulate for ever.
  if (from_sink || dest.pid == kBroadcastPid) return route;
  route.onward = Onward::kSerial;
  route.am_dest = router.sink_am;
  route.requirement = "N8-INCOMING"_rule;
  return route;
}

bool is_self(const Router& router, Address dest) {
  return dest.pid == router.own.pid &&
         (dest.devid == router.own.devid || dest.devid == kLocalDevid);
}

Route mote_own(const Router& router, Address dest) {
  const bool in_island = for_own_island(router, dest) && dest.devid != kNullDevid;
  //= N4-SINK: A mote sends a net_msg for another island, or with devid NULL, to the AM address of
  //= its sink.
  if (!in_island) return onward(Onward::kRadio, router.sink_am, "N4-SINK"_rule);
  return onward(Onward::kRadio, dest.devid, "N4-MOTE"_rule);
}

}  // namespace

Route route_received(const Router& router, Link from, Address dest, Address src) {
  if (router.role == Role::kMote && from == Link::kRadio) return mote_from_radio(router, dest);
  if (router.role == Role::kSink && from == Link::kRadio) {
    return sink_from_radio(router, dest, src);
  }
  if (router.role == Role::kSink && from == Link::kSerial) return sink_from_serial(router, dest);
  if (router.role == Role::kBaseStation && from != Link::kRadio) {
    return base_station_received(router, from, dest);
  }
  return nowhere(ReqId::kNone);  // A line that such a node does not have.
}

Route route_own(const Router& router, Address dest) {
  Route route;
  const bool here = for_own_island(router, dest);
  //= J11-SEND: A mote that is not a member sends no net_msg.
  if (!router.member) return nowhere("J11-SEND"_rule);
  //= N4-SELF: A node refuses a message whose dest is the node itself.
  if (is_self(router, dest)) return nowhere("N4-SELF"_rule);
  switch (router.role) {
    case Role::kMote: route = mote_own(router, dest); break;
    case Role::kSink:
      //= N6-OWN: What a sink itself sends to <its island, NULL> or to another island goes over
      //= serial.
      route = !here || dest.devid == kNullDevid
                  ? onward(Onward::kSerial, kAmBroadcast, "N6-OWN"_rule)
                  : onward(Onward::kRadio, dest.devid, "N4-MOTE"_rule);
      break;
    case Role::kBaseStation:
      //= N8-PEIS: A base station sends a message for another island, its own or its sink's, through
      //= PEIS to that island's base station.
      if (!here) return onward(Onward::kPeis, dest.pid, "N8-PEIS"_rule);
      if (dest.devid == kNullDevid) return nowhere("N4-SELF"_rule);  // Its own, in any island.
      route = onward(Onward::kSerial, router.sink_am, "N8-SERIAL"_rule);
      break;
  }
  //= N4-MOTE: On the radio a net_msg for a mote of the sender's own island is sent to that mote's
  //= AM address, a broadcast to AM address 0xFFFF.
  const bool broadcast = dest.pid == kBroadcastPid && dest.devid != kNullDevid;
  if (route.onward == Onward::kRadio && broadcast) route.am_dest = kAmBroadcast;
  return route;
}

}  // namespace rubric::machine
