// Mistakes of sinks in joining.

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
  add(out, "join_not_answered", "A sink answers no join_request.", {"J3-REPLY"_rule},
      drop_sent(is_reply));
  add(out, "reply_twice", "A sink sends each join_reply twice.", {"J3-ONCE"_rule},
      double_sent(is_reply));
  add(out, "reply_unasked", "A sink offers its island to whoever sends a net_msg.",
      {"J3-ONCE"_rule}, after_step([](Moment& moment) {
        const Frame* const frame = moment.heard(am::kNet);
        const bool room = moment.actions.transmits().size() + 2 <= Actions::kTransmitsMax;
        if (frame == nullptr || !moment.is(Role::kSink) || !room) return;
        Transmit& reply = moment.send(Link::kRadio, am::kJoinReply, frame->src, "J3-ONCE"_rule);
        reply.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
        put(reply, join_reply::kIsland, moment.state.island);
        put(reply, join_reply::kMote, frame->src);
      }));
  add(out, "reply_to_an_ack_join", "A sink answers ack_join with another join_reply.",
      {"J3-ONCE"_rule}, after_step([](Moment& moment) {
        const Frame* const frame = moment.heard(am::kAckJoin);
        if (frame == nullptr || !moment.is(Role::kSink)) return;
        Transmit& reply = moment.send(Link::kRadio, am::kJoinReply, frame->src, "J3-ONCE"_rule);
        reply.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
        put(reply, join_reply::kIsland, moment.state.island);
        put(reply, join_reply::kMote, frame->src);
      }));
  add(out, "reply_other_number", "A join_reply carries the number plus one.",
      {"J3-SEQ"_rule, "J3-REPLY"_rule},
      sent_field(am::kJoinReply, join_reply::kSeqNum,
                 [](const Moment&, unsigned v) { return v + 1; }));
  add(out, "reply_number_swapped", "The number of a join_reply has the wrong byte order.",
      {"J3-SEQ"_rule},
      sent_field(am::kJoinReply, join_reply::kSeqNum,
                 [](const Moment&, unsigned v) { return v >> 8 | (v & 0xFF) << 8; }));
  add(out, "reply_offers_the_sinks_devid", "mote_addr of a join_reply is the sink's own.",
      {"J3-ADDRESS"_rule}, sent_field(am::kJoinReply, join_reply::kMote, 1));
  add(out, "reply_offers_island_0", "island_addr of a join_reply is 0.", {"J3-ADDRESS"_rule},
      sent_field(am::kJoinReply, join_reply::kIsland, 0));
  add(out, "reply_broadcast", "A join_reply goes to everybody.", {"J3-DEST"_rule},
      edit_sent(am::kJoinReply,
                [](Moment&, Transmit& frame) { frame.dest = machine::kAmBroadcast; }));
  add(out, "cur_time_in_seconds", "cur_time of a join_reply is in seconds.",
      {"J3-DRIFT"_rule, "J3-TIME"_rule}, edit_sent(am::kJoinReply, [](Moment&, Transmit& frame) {
        put(frame, join_reply::kTime, get(frame, join_reply::kTime) / 1000);
      }));
  add(out, "cur_time_constant", "cur_time of a join_reply is always 12345.", {"J3-TIME"_rule},
      sent_field(am::kJoinReply, join_reply::kTime, 12345));
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
  add(out, "full_list_answers", "A sink with a full list answers a mote that is not in it.",
      {"J3-FULL"_rule}, always(answers_when_full));
  add(out, "newcomer_takes_a_members_place",
      "A sink with a full list forgets its oldest member for a newcomer's request.",
      {"J3-OVERWRITE"_rule, "J3-FULL"_rule}, always(take_a_members_place));
  add(out, "late_ack_takes_a_members_place",
      "An ack_join that finds the list full pushes the oldest member out.",
      {"J3-OVERWRITE"_rule, "J6-ADD"_rule}, always(late_ack_pushes_out));
  add(out, "listed_at_request", "A sink lists a mote that has asked, before its ack_join.",
      {"J3-REPLY"_rule, "J6-ADD"_rule, "J6-ONLY"_rule}, always(lists_at_request));
  add(out, "pending_join_overwritten", "A sink remembers one join, the newest.",
      {"J9-INTERLEAVE"_rule, "J6-ADD"_rule}, after_step([](Moment& moment) {
        auto& pending = moment.state.sink.pending;
        while (pending.size() > 1) pending.erase(0);
      }));
  add(out, "one_join_at_a_time", "A sink does not answer while another join is open.",
      {"J9-INTERLEAVE"_rule, "J3-REPLY"_rule}, on_heard([](Moment& moment, Forged& forged) {
        const auto& pending = moment.state.sink.pending;
        return forged.frame.type != am::kJoin || pending.empty() ||
               pending[0].devid == forged.frame.src;
      }));
  add(out, "descriptors_mixed", "A sink keeps one descriptor, that of the newest request.",
      {"J9-INTERLEAVE"_rule}, after_step([](Moment& moment) {
        auto& pending = moment.state.sink.pending;
        for (auto& one : pending) one.descriptor = pending[pending.size() - 1].descriptor;
      }));
  add(out, "answers_once", "A sink answers a mote's second request no more.", {"J3-REPLY"_rule},
      hear_only([](const Moment& moment, const Frame& frame) {
        return frame.type != am::kJoin ||
               machine::find_pending(moment.state.sink, frame.src) == nullptr;
      }));
}

// ack_join.

void add_acks(Mutants& out) {
  add(out, "ack_join_ignored", "A sink lists nobody.", {"J6-ADD"_rule},
      hear_only([](const Moment&, const Frame& frame) { return frame.type != am::kAckJoin; }));
  add(out, "ack_join_any_number", "A sink takes ack_join with any number.", {"J6-SEQ"_rule},
      edit_heard(am::kAckJoin, [](Moment& moment, Forged& forged) {
        const auto* asked =
            machine::find_pending(moment.state.sink, get(forged, ack_join::kSrcDevid));
        if (asked != nullptr) put(forged, ack_join::kSeqNum, asked->seq_num);
      }));
  add(out, "ack_join_of_any_island", "A sink takes ack_join for another island.",
      {"J6-ISLAND"_rule}, edit_heard(am::kAckJoin, [](Moment& moment, Forged& forged) {
        put(forged, ack_join::kDestPid, moment.state.island);
        put(forged, ack_join::kSrcPid, moment.state.island);
      }));
  add(out, "ack_join_of_any_sender", "A sink does not compare an ack_join with its AM source.",
      {"J6-SENDER"_rule}, edit_heard([](Moment& moment, Forged& forged) {
        if (forged.frame.type != am::kAckJoin || forged.size() < 14) return;
        put(forged, ack_join::kDestDevid, own(moment).devid);
        put(forged, ack_join::kSrcPid, get(forged, ack_join::kDestPid));
        forged.frame.src = get(forged, ack_join::kSrcDevid);
      }));
  add(out, "mote_joined_twice", "A repeated ack_join is one more join.", {"J6-REPEAT"_rule},
      before_step([](Moment& moment) {
        const Frame* const ack = moment.heard(am::kAckJoin);
        auto& sink = moment.state.sink;
        if (ack != nullptr && moment.is(Role::kSink) && !sink.pending.full()) {
          const auto* member = machine::find_member(sink, ack->src);
          if (member != nullptr) sink.pending.push(*member);
        }
      }));
  add(out, "mote_joined_silently", "A sink reports no member to its application.", {"J6-ADD"_rule},
      on_told_of<MoteJoined>([](Moment&, MoteJoined&) { return Fate::kDrop; }));
  add(out, "mote_joined_without_descriptor", "moteJoined has an empty descriptor.", {"J6-ADD"_rule},
      edit_told<MoteJoined>([](Moment&, MoteJoined& joined) { joined.descriptor = {}; }));
  add(out, "not_reported", "A sink reports no member to its base station.",
      {"J6-REPORT"_rule, "J6-CONTENT"_rule}, drop_sent(is_report));
  add(out, "reported_twice", "A sink reports a member twice.", {"J6-REPORT"_rule, "J6-REPEAT"_rule},
      double_sent(is_report));
  add(out, "serial_joined_with_wrong_descriptor", "serial_joined has no transducers.",
      {"J6-CONTENT"_rule}, sent_field(is_report, net::kReportedTransducers, 0));
  add(out, "serial_joined_of_the_sink", "serial_joined names the sink as the new member.",
      {"J6-CONTENT"_rule}, sent_field(is_report, net::kReportedMote, 1));
  add(out, "serial_joined_signed_by_the_sink", "serial_joined has the sink as its source.",
      {"J6-CONTENT"_rule}, sent_field(is_report, net::kSrcDevid, 1));
  add(out, "reported_at_request", "A sink reports a mote when it asks.",
      {"J6-ONLY"_rule, "J6-REPORT"_rule, "J6-ADD"_rule}, after_step([](Moment& moment) {
        const Frame* const request = moment.heard(am::kJoin);
        if (request == nullptr || !moment.is(Role::kSink)) return;
        Transmit& report =
            moment.send(Link::kSerial, am::kNet, machine::kAmBroadcast, "J6-REPORT"_rule);
        report.size_bytes = machine::kAmPayloadMax;
        put(report, net::kDestPid, moment.state.island);
        put(report, net::kDestDevid, machine::kNullDevid);
        put(report, net::kSrcPid, moment.state.island);
        put(report, net::kSrcDevid, request->src);
        report.payload[net::kNbytes] = net::kReportNbytes;
        report.payload[net::kTransId] = component::kConnless;
        report.payload[net::kAppId] = component::kControlLayer;
        report.payload[net::kBody] = net::kReport;
      }));
  add(out, "sink_becomes_a_member", "A sink that hears a join_reply acks it.", {"J10-SINK"_rule},
      after_step([](Moment& moment) {
        const Frame* const reply = moment.heard(am::kJoinReply);
        if (reply == nullptr || !moment.is(Role::kSink)) return;
        Transmit& ack = moment.send(Link::kRadio, am::kAckJoin, reply->src, "J10-SINK"_rule);
        ack.size_bytes = rubicon::AckJoinView::kMaxSizeBytes;
      }));
  add(out, "sink_takes_the_island_of_a_reply", "A sink adopts the island of a join_reply.",
      {"J10-SINK"_rule, "J3-ADDRESS"_rule}, after_step([](Moment& moment) {
        const Frame* const reply = moment.heard(am::kJoinReply);
        if (reply != nullptr && moment.is(Role::kSink)) {
          moment.state.island = get(*reply, join_reply::kIsland);
        }
      }));
}

}  // namespace

void sink_join_mutants(Mutants& out) {
  add_replies(out);
  add_list(out);
  add_acks(out);
}

}  // namespace rubric::mutants
