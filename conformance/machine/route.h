// Routes a net_msg: a pure function of who has it, where it came from, and its addresses. (paper:
// Island Collision Resolution and Safe Join, The Inter-Island Connectivity)
#pragma once

#include "codec/runtime/rule.h"
#include "conformance/machine/address.h"

namespace rubric::machine {

/// The node that routes.
struct Router {
  Role role = Role::kMote;
  Address own;                ///< A base station's devid is kNullDevid; pid is the island.
  bool member = true;         ///< A mote that has joined.
  std::uint16_t sink_am = 1;  ///< The AM address of sinks.
};

/// The route of a message. Both parts may apply: a broadcast from serial is delivered and radiated.
struct Route {
  enum class Onward : std::uint8_t { kNowhere, kRadio, kSerial, kPeis };
  bool deliver = false;
  Onward onward = Onward::kNowhere;
  std::uint16_t am_dest = 0;         ///< On the radio; over PEIS the island.
  ReqId requirement = ReqId::kNone;  ///< Why it goes onward, or, going nowhere, why not.
  ReqId delivered = ReqId::kNone;    ///< Why it is delivered.
};

/// Routes a message that came over `from`.
Route route_received(const Router& router, Link from, Address dest, Address src);
/// Routes a message of this node's own; dest.pid is no longer kLocalPid. Nowhere means refused.
Route route_own(const Router& router, Address dest);

}  // namespace rubric::machine
