// Tells beforehand what a node will refuse or lose. For programs with memory to count in and a user
// to tell: a node itself calls none of it.
#pragma once

#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/tinyos/am_header.h"
#include "conformance/node/node.h"
#include "conformance/node/wire.h"

namespace rubric {
namespace node {

inline Refusal Node::refusal(Address dest, bool reliable, size_t data_bytes) const {
  if (data_bytes > kAppDataMax) return Refusal::kTooLong;
  if (!is_member()) return Refusal::kNotJoined;
  Route route = Route();
  if (!route_own(dest, route)) return Refusal::kNoWay;
  if (reliable && awaiting_.full()) return Refusal::kAwaiting;
  if (!at(route.line).on) return Refusal::kOff;
  return is_full(route.line) ? Refusal::kFull : Refusal::kNone;
}

inline bool Node::finds_no_room(Line line, Bytes packet) const {
  const auto header = tinyos::AmHeaderView::parse(packet);
  if (!header || !is_for_me(line, header->dest()) || header->type() != kAmNet) return false;
  const auto message = rubicon::NetMsgView::parse(packet.from(kAmHeaderBytes));
  if (!message || !is_member()) return false;
  const Address dest = address_of(message->dest());
  const Route route = route_received(line, dest, address_of(message->src()));
  return route.onward && is_full(route.line);
}

}  // namespace node
}  // namespace rubric
