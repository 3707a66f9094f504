// Tells which motes have left: those that fell silent. For the driver of a sink or base station
// that wants to know; a node without it calls no mote gone. (decision 124)
#pragma once

#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/tinyos/am_header.h"
#include "conformance/node/node.h"
#include "conformance/node/wire.h"

namespace rubric {
namespace node {

/// Watches at most kRoom motes; those beyond are never gone.
template <uint8_t kRoom>
class Silence {
 public:
  /// Begins anew; `gone_after` is the silence that means a mote has left, 0 for never.
  void start(Ticks gone_after) {
    gone_after_ = gone_after;
    count_ = 0;
  }
  /// Notes who is there; for the driver after Node::received of the same packet.
  void received(Node& node, Role role, Line line, Bytes packet, Ticks now);
  /// Forgets motes that have left and tells the application; returns as Node::run does.
  bool run(Node& node, Application& application, Ticks now, Ticks& due);

 private:
  struct Presence {
    uint16_t devid;
    Ticks heard;
  };
  static uint16_t living(Node& node, Role role, Line line, Bytes packet);

  Presence present_[kRoom];
  uint8_t count_ = 0;
  Ticks gone_after_ = 0;
  uint16_t island_ = 0;
};

// Returns the mote of the island that shows life by this packet; the NULL devid: none. A
// join_request shows none: a member asks no more, so the one that is listed has started anew.
template <uint8_t kRoom>
uint16_t Silence<kRoom>::living(Node& node, Role role, Line line, Bytes packet) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  if (!header || role == Role::kMote || !node.interface_is_on(line)) return kNullDevid;
  if (role == Role::kSink) {
    const bool mine = header->dest() == node.address().devid || header->dest() == kBroadcast;
    const bool counts = line == Line::kRadio && mine && header->type() != kAmJoin;
    return counts && node.lists(header->src()) ? header->src() : kNullDevid;
  }
  const auto message = rubicon::NetMsgView::parse(packet.from(kAmHeaderBytes));
  if (line != Line::kSerial || header->type() != kAmNet || !message) return kNullDevid;
  const Address src = address_of(message->src());
  const bool mote =
      src.pid == node.address().pid && !is_reserved(src.devid) && src.devid != kSinkId;
  return mote ? src.devid : kNullDevid;
}

template <uint8_t kRoom>
void Silence<kRoom>::received(Node& node, Role role, Line line, Bytes packet, Ticks now) {
  if (gone_after_ == 0) return;
  const uint16_t devid = living(node, role, line, packet);
  if (devid == kNullDevid) return;
  uint8_t i = 0;
  while (i < count_ && present_[i].devid != devid) ++i;
  if (i == kRoom) return;
  if (i == count_) ++count_;
  present_[i] = {devid, now};
}

template <uint8_t kRoom>
bool Silence<kRoom>::run(Node& node, Application& application, Ticks now, Ticks& due) {
  // A new island has no motes yet.
  if (island_ != node.address().pid) count_ = 0;
  island_ = node.address().pid;
  bool any = false;
  for (uint8_t i = 0; i < count_;) {
    const Presence one = present_[i];
    const bool gone = static_cast<Ticks>(now - one.heard) >= gone_after_;
    if (gone && !node.forget(one.devid)) present_[i].heard = now;
    if (present_[i].heard != one.heard) continue;
    if (!gone) {
      const Ticks end = one.heard + gone_after_;
      if (!any || is_reached(end, due)) due = end;
      any = true;
      ++i;
      continue;
    }
    present_[i] = present_[--count_];
    application.mote_left({island_, one.devid});
  }
  return any;
}

}  // namespace node
}  // namespace rubric
