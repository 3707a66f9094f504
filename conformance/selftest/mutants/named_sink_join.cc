// Mistakes of sinks in joining.
#include <algorithm>

#include "conformance/machine/join.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::MoteJoined;

bool is_reply(const Moment&, const Transmit& frame) { return frame.type == am::kJoinReply; }
bool is_report(const Moment& moment, const Transmit& frame) {
  return frame.link == Link::kSerial && is_net(frame) && moment.heard(am::kAckJoin) != nullptr;
}

void add_replies(Mutants& out) {
  out.push_back({"join_not_answered",
                 "A sink answers no join_request.",
                 {"J3-REPLY"_rule},
                 drop_sent(is_reply)});
  out.push_back({"reply_twice",
                 "A sink sends each join_reply twice.",
                 {"J3-ONCE"_rule},
                 double_sent(is_reply)});
  out.push_back({"reply_unasked",
                 "A sink offers its island to whoever sends a net_msg.",
                 {"J3-ONCE"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const frame = moment.heard(am::kNet);
                   const bool room =
                       moment.actions.transmits().size() + 2 <= Actions::kTransmitsMax;
                   if (frame == nullptr || !moment.is(Role::kSink) || !room) return;
                   Transmit& reply =
                       moment.send(Link::kRadio, am::kJoinReply, frame->src, "J3-ONCE"_rule);
                   reply.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
                   put(reply, join_reply::kIsland, moment.state.island);
                   put(reply, join_reply::kMote, frame->src);
                 })});
  out.push_back({"reply_to_an_ack_join",
                 "A sink answers ack_join with another join_reply.",
                 {"J3-ONCE"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const frame = moment.heard(am::kAckJoin);
                   if (frame == nullptr || !moment.is(Role::kSink)) return;
                   Transmit& reply =
                       moment.send(Link::kRadio, am::kJoinReply, frame->src, "J3-ONCE"_rule);
                   reply.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
                   put(reply, join_reply::kIsland, moment.state.island);
                   put(reply, join_reply::kMote, frame->src);
                 })});
  out.push_back({"reply_other_number",
                 "A join_reply carries the number plus one.",
                 {"J3-SEQ"_rule, "J3-REPLY"_rule},
                 sent_field(am::kJoinReply, join_reply::kSeqNum,
                            [](const Moment&, unsigned v) { return v + 1; })});
  out.push_back({"reply_number_swapped",
                 "The number of a join_reply has the wrong byte order.",
                 {"J3-SEQ"_rule},
                 sent_field(am::kJoinReply, join_reply::kSeqNum,
                            [](const Moment&, unsigned v) { return v >> 8 | (v & 0xFF) << 8; })});
  out.push_back(
      {"reply_offers_the_sinks_devid",
       "mote_addr of a join_reply is the sink's own.",
       {"J3-ADDRESS"_rule},
       sent_field(am::kJoinReply, join_reply::kMote, [](const Moment&, unsigned) { return 1U; })});
  out.push_back({"reply_offers_island_0",
                 "island_addr of a join_reply is 0.",
                 {"J3-ADDRESS"_rule},
                 sent_field(am::kJoinReply, join_reply::kIsland,
                            [](const Moment&, unsigned) { return 0U; })});
  out.push_back({"reply_broadcast",
                 "A join_reply goes to everybody.",
                 {"J3-DEST"_rule},
                 on_sent([](Moment&, const Action&, Transmit& frame) {
                   if (frame.type == am::kJoinReply) frame.dest = machine::kAmBroadcast;
                   return Fate::kKeep;
                 })});
  out.push_back({"cur_time_in_seconds",
                 "cur_time of a join_reply is in seconds.",
                 {"J3-DRIFT"_rule, "J3-TIME"_rule},
                 on_sent([](Moment&, const Action&, Transmit& frame) {
                   if (frame.type != am::kJoinReply) return Fate::kKeep;
                   put(frame, join_reply::kTime, get(frame, join_reply::kTime) / 1000);
                   return Fate::kKeep;
                 })});
  out.push_back({"cur_time_constant",
                 "cur_time of a join_reply is always 12345.",
                 {"J3-TIME"_rule},
                 on_sent([](Moment&, const Action&, Transmit& frame) {
                   if (frame.type != am::kJoinReply) return Fate::kKeep;
                   put(frame, join_reply::kTime, 12345);
                   return Fate::kKeep;
                 })});
}

// The list.

void take_a_members_place(Moment& moment) {
  auto& members = moment.state.sink.members;
  const Frame* const request = moment.heard(am::kJoin);
  const bool sink = moment.is(Role::kSink) && request != nullptr;
  if (sink && members.full() && machine::find_member(moment.state.sink, request->src) == nullptr) {
    members.erase(0);
  }
  moment.honest();
}

void answers_when_full(Moment& moment) {
  auto& members = moment.state.sink.members;
  const Frame* const request = moment.heard(am::kJoin);
  const bool full = moment.is(Role::kSink) && request != nullptr && members.full();
  const machine::JoinSink before = moment.state.sink;
  const bool listed = full && machine::find_member(before, request->src) != nullptr;
  if (full && !listed) members.erase(0);
  moment.honest();
  if (full && !listed) moment.state.sink.members = before.members;
}

void late_ack_pushes_out(Moment& moment) {
  auto& members = moment.state.sink.members;
  const Frame* const ack = moment.heard(am::kAckJoin);
  const bool pending = moment.is(Role::kSink) && ack != nullptr && members.full() &&
                       machine::find_pending(moment.state.sink, ack->src) != nullptr;
  if (pending) members.erase(0);
  moment.honest();
}

void lists_at_request(Moment& moment) {
  moment.honest();
  const Frame* const request = moment.heard(am::kJoin);
  if (request == nullptr || !moment.is(Role::kSink)) return;
  auto& sink = moment.state.sink;
  const machine::Admission* const asked = machine::find_pending(sink, request->src);
  if (asked != nullptr && !sink.members.full()) sink.members.push(*asked);
}

void add_list(Mutants& out) {
  out.push_back({"full_list_answers",
                 "A sink with a full list answers a mote that is not in it.",
                 {"J3-FULL"_rule},
                 always(answers_when_full)});
  out.push_back({"newcomer_takes_a_members_place",
                 "A sink with a full list forgets its oldest member for a newcomer's request.",
                 {"J3-OVERWRITE"_rule, "J3-FULL"_rule},
                 always(take_a_members_place)});
  out.push_back({"late_ack_takes_a_members_place",
                 "An ack_join that finds the list full pushes the oldest member out.",
                 {"J3-OVERWRITE"_rule, "J6-ADD"_rule},
                 always(late_ack_pushes_out)});
  out.push_back({"listed_at_request",
                 "A sink lists a mote that has asked, before its ack_join.",
                 {"J3-REPLY"_rule, "J6-ADD"_rule, "J6-ONLY"_rule},
                 always(lists_at_request)});
  out.push_back({"pending_join_overwritten",
                 "A sink remembers one join, the newest.",
                 {"J9-INTERLEAVE"_rule, "J6-ADD"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   auto& pending = moment.state.sink.pending;
                   while (pending.size() > 1) pending.erase(0);
                 })});
  out.push_back({"one_join_at_a_time",
                 "A sink does not answer while another join is open.",
                 {"J9-INTERLEAVE"_rule, "J3-REPLY"_rule},
                 on_heard([](Moment& moment, Forged& forged) {
                   const auto& pending = moment.state.sink.pending;
                   return forged.frame.type != am::kJoin || pending.empty() ||
                          pending[0].devid == forged.frame.src;
                 })});
  out.push_back({"descriptors_mixed",
                 "A sink keeps one descriptor, that of the newest request.",
                 {"J9-INTERLEAVE"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   auto& pending = moment.state.sink.pending;
                   for (auto& one : pending)
                     one.descriptor = pending[pending.size() - 1].descriptor;
                 })});
  out.push_back({"answers_once",
                 "A sink answers a mote's second request no more.",
                 {"J3-REPLY"_rule},
                 on_heard([](Moment& moment, Forged& forged) {
                   return forged.frame.type != am::kJoin ||
                          machine::find_pending(moment.state.sink, forged.frame.src) == nullptr;
                 })});
}

// ack_join.

void add_acks(Mutants& out) {
  out.push_back(
      {"ack_join_ignored",
       "A sink lists nobody.",
       {"J6-ADD"_rule},
       on_heard([](Moment&, Forged& forged) { return forged.frame.type != am::kAckJoin; })});
  out.push_back({"ack_join_any_number",
                 "A sink takes ack_join with any number.",
                 {"J6-SEQ"_rule},
                 on_heard([](Moment& moment, Forged& forged) {
                   if (forged.frame.type != am::kAckJoin) return true;
                   const auto* asked =
                       machine::find_pending(moment.state.sink, get(forged, ack_join::kSrcDevid));
                   if (asked != nullptr) put(forged, ack_join::kSeqNum, asked->seq_num);
                   return true;
                 })});
  out.push_back({"ack_join_of_any_island",
                 "A sink takes ack_join for another island.",
                 {"J6-ISLAND"_rule},
                 on_heard([](Moment& moment, Forged& forged) {
                   if (forged.frame.type == am::kAckJoin) {
                     put(forged, ack_join::kDestPid, moment.state.island);
                     put(forged, ack_join::kSrcPid, moment.state.island);
                   }
                   return true;
                 })});
  out.push_back({"ack_join_of_any_sender",
                 "A sink does not compare an ack_join with its AM source.",
                 {"J6-SENDER"_rule},
                 on_heard([](Moment& moment, Forged& forged) {
                   if (forged.frame.type != am::kAckJoin || forged.size() < 14) return true;
                   put(forged, ack_join::kDestDevid, own(moment).devid);
                   put(forged, ack_join::kSrcPid, get(forged, ack_join::kDestPid));
                   forged.frame.src = get(forged, ack_join::kSrcDevid);
                   return true;
                 })});
  out.push_back({"mote_joined_twice",
                 "A repeated ack_join is one more join.",
                 {"J6-REPEAT"_rule},
                 always([](Moment& moment) {
                   const Frame* const ack = moment.heard(am::kAckJoin);
                   auto& sink = moment.state.sink;
                   if (ack != nullptr && moment.is(Role::kSink) && !sink.pending.full()) {
                     const auto* member = machine::find_member(sink, ack->src);
                     if (member != nullptr) sink.pending.push(*member);
                   }
                   moment.honest();
                 })});
  out.push_back({"mote_joined_silently",
                 "A sink reports no member to its application.",
                 {"J6-ADD"_rule},
                 on_told_of<MoteJoined>([](Moment&, MoteJoined&) { return Fate::kDrop; })});
  out.push_back({"mote_joined_without_descriptor",
                 "moteJoined has an empty descriptor.",
                 {"J6-ADD"_rule},
                 on_told_of<MoteJoined>([](Moment&, MoteJoined& joined) {
                   joined.descriptor = {};
                   return Fate::kKeep;
                 })});
  out.push_back({"not_reported",
                 "A sink reports no member to its base station.",
                 {"J6-REPORT"_rule, "J6-CONTENT"_rule},
                 drop_sent(is_report)});
  out.push_back({"reported_twice",
                 "A sink reports a member twice.",
                 {"J6-REPORT"_rule, "J6-REPEAT"_rule},
                 double_sent(is_report)});
  out.push_back({"serial_joined_with_wrong_descriptor",
                 "serial_joined has no transducers.",
                 {"J6-CONTENT"_rule},
                 on_sent([](Moment& moment, const Action&, Transmit& frame) {
                   if (is_report(moment, frame)) put(frame, net::kReportedTransducers, 0);
                   return Fate::kKeep;
                 })});
  out.push_back({"serial_joined_of_the_sink",
                 "serial_joined names the sink as the new member.",
                 {"J6-CONTENT"_rule},
                 on_sent([](Moment& moment, const Action&, Transmit& frame) {
                   if (is_report(moment, frame)) put(frame, net::kReportedMote, 1);
                   return Fate::kKeep;
                 })});
  out.push_back({"serial_joined_signed_by_the_sink",
                 "serial_joined has the sink as its source.",
                 {"J6-CONTENT"_rule},
                 on_sent([](Moment& moment, const Action&, Transmit& frame) {
                   if (is_report(moment, frame)) put(frame, net::kSrcDevid, 1);
                   return Fate::kKeep;
                 })});
  out.push_back({"reported_at_request",
                 "A sink reports a mote when it asks.",
                 {"J6-ONLY"_rule, "J6-REPORT"_rule, "J6-ADD"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const request = moment.heard(am::kJoin);
                   if (request == nullptr || !moment.is(Role::kSink)) return;
                   Transmit& report = moment.send(Link::kSerial, am::kNet, machine::kAmBroadcast,
                                                  "J6-REPORT"_rule);
                   report.size_bytes = machine::kAmPayloadMax;
                   put(report, net::kDestPid, moment.state.island);
                   put(report, net::kDestDevid, machine::kNullDevid);
                   put(report, net::kSrcPid, moment.state.island);
                   put(report, net::kSrcDevid, request->src);
                   report.payload[net::kNbytes] = net::kReportNbytes;
                   report.payload[net::kTransId] = component::kConnless;
                   report.payload[net::kAppId] = component::kControlLayer;
                   report.payload[net::kBody] = net::kReport;
                 })});
  out.push_back({"sink_becomes_a_member",
                 "A sink that hears a join_reply acks it.",
                 {"J10-SINK"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const reply = moment.heard(am::kJoinReply);
                   if (reply == nullptr || !moment.is(Role::kSink)) return;
                   Transmit& ack =
                       moment.send(Link::kRadio, am::kAckJoin, reply->src, "J10-SINK"_rule);
                   ack.size_bytes = rubicon::AckJoinView::kMaxSizeBytes;
                 })});
  out.push_back({"sink_takes_the_island_of_a_reply",
                 "A sink adopts the island of a join_reply.",
                 {"J10-SINK"_rule, "J3-ADDRESS"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const reply = moment.heard(am::kJoinReply);
                   if (reply != nullptr && moment.is(Role::kSink)) {
                     moment.state.island = get(*reply, join_reply::kIsland);
                   }
                 })});
}

}  // namespace

Mutants sink_join_mutants() {
  Mutants out;
  add_replies(out);
  add_list(out);
  add_acks(out);
  return out;
}

}  // namespace rubric::mutants
