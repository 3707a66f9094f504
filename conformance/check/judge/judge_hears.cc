// What a node may make of a message that comes to it: the part of the second pass that knows which
// messages are for whom.
#include <algorithm>

#include "conformance/check/judge/judge_pass.h"
#include "conformance/check/links.h"
#include "conformance/machine/transport.h"

namespace rubric::check {
using machine::Role;

// Takes what no node hears. Reports a packet whose check sum is right, so that no line damaged it,
// and whose length is not.
void Judge::malformed(const Observation& seen) {
  std::uint16_t sender = kNobody;
  if (seen.tap < who_.sink_of_tap.size()) sender = who_.sink_of_tap[seen.tap];
  if (seen.broken != "WIRE-AM-LENGTH"_rule) {
    // It may have been SET_ISLAND_ID.
    if (sender == kNobody || (run_.taps[seen.tap].has_direction && !seen.to_mote)) return;
    sinks_.perhaps_told(sender);
    return forwarding_.perhaps_told(sender);
  }
  if (sender != kNobody && seen.to_mote) sender = who_.devices[sender].partner;
  context_.report(seen.broken, Severity::kFail, seen.place, sender,
                  {"The length of a packet on a serial line is not that of its bytes.",
                   "The number of bytes after the header, at most 114.",
                   {}});
}

void Judge::mote_hears(std::uint32_t index, std::uint16_t mote, const Observation& seen,
                       const Mark& mark, const Net& net) {
  const std::uint16_t am = who_.devices[mote].am;
  const std::optional<machine::Address> own = motes_.address(mote);
  // If its island is uncertain, anything for its devid may be for it.
  const machine::Address presumed = own.value_or(machine::Address{net.dest.pid, am});
  // A link ack of the one node with that address shows that its radio received the frame
  // (decision 127), and former acks that its application is there (decision 111).
  const bool linked = !who_.devices[mote].hearing && seen.frame.dest == am && own &&
                      context_.mote_of_am[am] == mote && context_.next_of_am[mote] == kNobody &&
                      motes_.surely_member(mote) && acks_.acks_for(mote, net.app_id) &&
                      link_acked(run_, index);
  hears(mote, {Role::kMote, presumed, true, context_.sink_am}, machine::Link::kRadio, seen,
        mark.device, net, mark.receiver == mote || linked);
}

// Reports a message that ends before it is whole, though its frame is sound.
void Judge::cut_off(const Observation& seen, std::uint16_t sender) {
  if (sender == kNobody || seen.received) return;
  const Bytes bytes = seen.frame.payload;
  Error error;
  switch (seen.frame.type) {
    case am::kJoin: error = rubicon::JoinRequestView::check(bytes); break;
    case am::kJoinReply: error = rubicon::JoinReplyView::check(bytes); break;
    case am::kAckJoin: error = rubicon::AckJoinView::check(bytes); break;
    default: error = rubicon::NetMsgView::check(bytes); break;
  }
  context_.report(error.requirement, Severity::kFail, seen.place, sender,
                  {"A message of " + number(bytes.size()) + " bytes ends before it is whole.",
                   "All of its fields.",
                   {}});
}

// Takes SET_ISLAND_ID that a sink is given, for sure or perhaps.
void Judge::island_told(std::uint16_t sink, const Place& at, std::uint16_t island, bool sure) {
  if (interfaces_.switched_off(sink, machine::Link::kSerial)) {  // It hears nothing.
    return sinks_.missed_island(sink, island);
  }
  acks_.interrupted(sink, at.time_us);
  announcements_.ends(sink, at.time_us);
  sinks_.set_island(sink, island, at, sure);
  forwarding_.set_island(sink, island, at.time_us, sure);
}

// Returns whether it is a sink's message of its own, by its source. Where that is of an island that
// the sink may have again, it is the sink's from now on.
bool Judge::is_sinks_own(std::uint16_t sink, const Observation& seen, const Net& net) {
  const std::uint16_t before = sinks_.island(sink);
  const bool own = sinks_.is_own(sink, net.src, seen.place.time_us);
  const bool former = !own && sinks_.is_former(sink, net.src, seen.place);
  if (former || (own && net.src.pid == sinks_.island(sink))) {
    island_shown(sink, before, seen.place.time_us);
  }
  return own || former;
}

// Takes the island that a sink shows, of island `before` until then: it may not have taken the one
// that it was told, or have lost it.
void Judge::island_shown(std::uint16_t sink, std::uint16_t before, std::int64_t now_us) {
  // Its base station goes on with the island that it told the sink.
  const std::uint16_t base = who_.devices[sink].partner;
  const bool moved = before != kNoIsland && before != sinks_.island(sink);
  if (moved && base != kNobody) own_island_.try_emplace(base, before);
  sinks_.acts(sink, now_us);
  forwarding_.acts(sink, sinks_.island(sink), now_us);
}

// Returns what a mote by its own log is to the messages that it hears.
Judge::Standing Judge::standing(std::uint16_t node) const {
  const Device& device = who_.devices[node];
  if (!is(node, Role::kMote) || !device.hearing) return Standing::kMember;
  const std::vector<MoteHypothesis>& set = motes_.set(node);
  // It may have joined before the log.
  if (std::ranges::any_of(set, &MoteHypothesis::unknown)) return Standing::kUnknown;
  if (motes_.is_outside(node)) return Standing::kOutside;
  // It need not see itself as a member before joined(SUCCESS) (decisions 102, 118).
  const bool sure = motes_.address(node) && (!device.application || motes_.surely_member(node));
  return sure ? Standing::kMember : Standing::kPerhaps;
}

bool Judge::no_room(std::uint16_t node, const Net& net) const {
  const bool to_base = net.src.devid == machine::kNullDevid;
  const bool by_serial = is(node, Role::kBaseStation) || (is(node, Role::kSink) && to_base);
  return originals_.full(node, by_serial ? machine::Link::kSerial : machine::Link::kRadio);
}

// Says of a message whether its delivery is owed, free or forbidden, by the rule of its route.
//= N5-DELIVER: A mote delivers a net_msg, sent or sent on by a node of its island, whose dest is
//= its island and its own devid or the broadcast devid.
//= N5-FOREIGN: A mote ignores a net_msg whose dest.pid is another island; 0xFFFF, every island, may
//= be delivered or ignored.
//= N5-OTHER: A mote ignores a net_msg of its own island whose devid is another mote or NULL.
//= N6-DELIVER: A sink delivers a net_msg from the radio, sent by a node of its island, whose dest
//= is its island and its own devid or the broadcast devid.
//= N7-DELIVER: A sink delivers a net_msg from serial for its island whose devid is its own or the
//= broadcast devid.
//= N8-DELIVER: A base station delivers a message with dest <its island, NULL> to its application.
void Judge::hears(std::uint16_t node, const machine::Router& router, machine::Link from,
                  const Observation& seen, std::uint16_t sender, const Net& net, bool sure) {
  if (router.own.pid == kNoIsland) return;  // A sink of which no island is known.
  const machine::Route route = machine::route_received(router, from, net.dest, net.src);
  // A message to every island may be taken or ignored (decision 114); so may any by a sink of which
  // nobody knows the island any more.
  const bool lost = is(node, Role::kSink) && sinks_.may_have_lost_island(node, seen.place.time_us);
  const bool free = route.deliver || net.dest.pid == machine::kBroadcastPid || lost;
  const bool off = interfaces_.off(node, from, seen.place.time_us);
  const Standing standing = this->standing(node);
  ReqId forbidden = free ? ReqId::kNone : route.requirement;
  // A message to be passed on is for somebody else; one that a sink hands up is for the base
  // station, or for another island.
  const bool onward = route.onward != machine::Route::Onward::kNowhere;
  const bool base = is(node, Role::kBaseStation);
  if (!free && base) forbidden = "N8-DELIVER"_rule;
  if (!free && onward && !base) {
    forbidden = from == machine::Link::kRadio ? "N6-DELIVER"_rule : "N7-DELIVER"_rule;
  }
  if (standing == Standing::kOutside) forbidden = "J11-HEAR"_rule;
  if (off) forbidden = "N10-OFF"_rule;
  // So may one straight from a foreign mote (decision 116), and one for another island that a base
  // station sends down to its sink (decision 126).
  const bool radio = from == machine::Link::kRadio;
  const bool straight = net.dest.pid != router.own.pid ||
                        (radio && net.src.pid != net.dest.pid && !is(sender, Role::kSink) &&
                         seen.frame.src != context_.sink_am) ||
                        standing == Standing::kPerhaps;
  const bool cut = cut_on_line(node, seen);
  // A base station need not deliver what is for all of its island (N8-DELIVER).
  const bool owed = is(node, Role::kMote) ? motes_.surely_member(node)
                                          : !is(node, Role::kBaseStation) ||
                                                net.dest.devid != machine::kBroadcastDevid;
  const bool on = !interfaces_.switched_off(node, from);
  acks_.arrived(node, seen, sender, net,
                {forbidden, forbidden == "N6-OTHER"_rule, sure && on, straight || cut,
                 standing == Standing::kUnknown,
                 !owed              ? ReqId::kNone
                 : cut && !straight ? "N11-SHORT"_rule
                                    : route.delivered,
                 no_room(node, net), net.dest == router.own, sure});
  if (sure) synaptic_.heard(node, seen, net);
  if (sure && !off && route.deliver) synaptic_.given(node, seen, net, on);
  const bool exact = net.dest == router.own && owed && !straight && !cut && on && !off;
  if (sure && exact && forbidden == ReqId::kNone && context_.options.start_cold) {
    synaptic_.owed(node, seen, net);
  }
}

// Takes what a log gives a node whose interface is switched off: it must do nothing with it.
void Judge::given_off(const Observation& seen, const Mark& mark, const Net& net) {
  const machine::Link link = seen.frame.link;
  if (mark.receiver == kNobody || !interfaces_.switched_off(mark.receiver, link)) return;
  // What was on its way as it was switched off may still come.
  const bool off = interfaces_.off(mark.receiver, link, seen.place.time_us);
  if (seen.kind == Observation::Kind::kSerial) return peis_.came_while_off(mark.receiver, net, off);
  forwarding_.heard_on_radio(seen, mark.device, net, off ? kNobody : mark.receiver,
                             off ? mark.receiver : kNobody);
}

// Returns how long the node of that address waits for an ack: its timer runs, not that of the node
// that acks. Of several, or where islands are not known, it is the longest.
std::int64_t Judge::ack_timeout_us(machine::Address address) const {
  std::int64_t longest_us = -1;
  for (std::uint16_t node = 0; node < run_.nodes.size(); ++node) {  // No other states one.
    const bool base = is(node, Role::kBaseStation);
    const std::uint16_t island = address_of(node).pid;
    if ((base ? machine::kNullDevid : who_.devices[node].am) != address.devid) continue;
    if (island != address.pid && island != kNoIsland) continue;
    longest_us = std::max(longest_us, context_.ack_timeout_us(node));
  }
  return longest_us >= 0 ? longest_us : context_.ack_timeout_us(kNobody);
}

void Judge::ack_comes(std::uint32_t index, const Net& ack, const Observation& seen,
                      std::uint16_t given) {
  if (given != kNobody && interfaces_.switched_off(given, seen.frame.link)) return;
  if (given != kNobody) originals_.ack_given(given, ack, seen.place.time_us);
  const std::int32_t acked = machine::acked_seq_num(ack.body());
  if (acked < 0) return;
  const auto seq_num = static_cast<std::uint16_t>(acked);
  context_.for_motes(ack.dest.devid, [&](std::uint16_t mote) {
    const std::uint16_t island = motes_.address(mote).value_or(ack.dest).pid;
    if (island != ack.dest.pid) return;
    // On the air to its sink, or up that one's line, it has not yet come to the mote.
    const bool last = seen.kind == Observation::Kind::kRadio && seen.frame.dest == ack.dest.devid;
    const bool sure = given == mote || link_acked(run_, index);
    const Wait wait = !last ? Wait::kRuns : sure ? Wait::kOver : Wait::kPerhaps;
    originals_.ack_heard(mote, ack, seq_num, wait);
  });
  for (const std::uint16_t sink : context_.sinks) {
    const Device& device = who_.devices[sink];
    const machine::Address own{sinks_.island(sink), device.am};
    if (ack.dest == own) originals_.ack_heard(sink, ack, seq_num, Wait::kOver);
    if (device.partner == kNobody || ack.dest != address_of(device.partner)) continue;
    originals_.ack_heard(device.partner, ack, seq_num, Wait::kOver);
  }
}

// A base station is given a message for sure where its own log says so.
void Judge::base_station_hears(std::uint16_t sink, const Observation& seen, const Mark& mark,
                               const Net& net) {
  const std::uint16_t base = who_.devices[sink].partner;
  if (base == kNobody) return;
  const std::int64_t now = seen.place.time_us;
  const bool on = !interfaces_.switched_off(base, machine::Link::kSerial);
  const machine::Address own = address_of(base);
  peis_.came_up(base, own.pid, seen, net, on);
  if (!on && seen.received)
    peis_.came_while_off(base, net, interfaces_.off(base, machine::Link::kSerial, now));
  hears(base, {Role::kBaseStation, own, true, context_.sink_am}, machine::Link::kSerial, seen, sink,
        net, mark.receiver == base);
}

}  // namespace rubric::check
