// Mistakes of motes with a join_reply: which they accept, what they do with it, ack_join.
#include <algorithm>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using Phase = machine::JoinMote::Phase;

bool is_reply_for(const Moment& moment, const Frame& frame) {
  return moment.is(Role::kMote) && frame.type == am::kJoinReply && frame.payload.size() == 10 &&
         frame.dest == moment.state.config.id;
}

// Acceptance.

void add_acceptance(Mutants& out) {
  add(out, "no_ack_join", "A mote that accepts a reply does not ack it.", {"J4-ACK"_rule},
      drop_sent([](const Moment&, const Transmit& frame) { return frame.type == am::kAckJoin; }));
  add(out, "ack_join_other_number", "ack_join carries the number plus one.",
      {"J4-CONTENT"_rule, "J4-ACK"_rule},
      sent_field(am::kAckJoin, ack_join::kSeqNum, [](const Moment&, unsigned v) { return v + 1; }));
  add(out, "ack_join_swaps_addresses", "Source and destination of ack_join are swapped.",
      {"J4-CONTENT"_rule}, edit_sent(am::kAckJoin, [](Moment&, Transmit& frame) {
        std::swap_ranges(frame.payload.begin() + ack_join::kDestPid,
                         frame.payload.begin() + ack_join::kDestDevid.kEnd,
                         frame.payload.begin() + ack_join::kSrcPid);
      }));
  add(out, "ack_join_without_island", "The source of ack_join has no island yet.",
      {"J4-CONTENT"_rule}, sent_field(am::kAckJoin, ack_join::kSrcPid, 0));
  add(out, "ack_join_old_descriptor", "ack_join has a descriptor without transducers.",
      {"J4-CONTENT"_rule}, sent_field(am::kAckJoin, ack_join::kTransducers, 0));
  add(out, "ack_join_broadcast", "ack_join goes to everybody.", {"J4-CONTENT"_rule, "J4-ACK"_rule},
      edit_sent(am::kAckJoin,
                [](Moment&, Transmit& frame) { frame.dest = machine::kAmBroadcast; }));
  add(out, "wrong_seq_accepted_and_acked_as_it_is",
      "A mote that is joining takes any number, and adopts it.", {"J4-SEQ"_rule, "J5-ACCEPT"_rule},
      before_step([](Moment& moment) {
        const Frame* const frame = moment.heard();
        if (frame != nullptr && is_reply_for(moment, *frame) && is_joining(moment)) {
          moment.state.join.seq_num = get(*frame, join_reply::kSeqNum);
        }
      }));
  add(out, "reply_accepted_by_a_member", "A member that hears a reply changes its island.",
      {"J4-JOINED"_rule, "J7-ONE"_rule, "J7-CHOICE"_rule}, before_step([](Moment& moment) {
        const Frame* const frame = moment.heard();
        if (frame != nullptr && is_reply_for(moment, *frame) && is_member(moment)) {
          moment.state.join.phase = Phase::kJoining;
          moment.state.join.seq_num = get(*frame, join_reply::kSeqNum);
        }
      }));
  add(out, "reply_accepted_outside", "A mote without a request accepts a reply.",
      {"J4-JOINED"_rule, "J5-ACCEPT"_rule, "J1-CALLED"_rule}, before_step([](Moment& moment) {
        const Frame* const frame = moment.heard();
        if (frame != nullptr && is_reply_for(moment, *frame) && !is_member(moment)) {
          moment.state.join.phase = Phase::kJoining;
          moment.state.join.seq_num = get(*frame, join_reply::kSeqNum);
        }
      }));
  add(out, "reply_for_another_accepted", "mote_addr of a reply is not looked at.",
      {"J4-ADDRESS"_rule}, edit_heard(is_reply_for, [](Moment& moment, Forged& forged) {
        put(forged, join_reply::kMote, moment.state.config.id);
      }));
  add(out, "clock_not_set", "A mote that joins keeps its own clock.", {"J4-CLOCK"_rule},
      always([](Moment& moment) {
        const std::uint32_t offset = moment.state.clock_offset_ms;
        moment.honest();
        if (moment.heard(am::kJoinReply) != nullptr) {
          moment.state.clock_offset_ms = offset;
        }
      }));
  add(out, "clock_stands", "A mote's clock stays at cur_time.", {"J4-CLOCK"_rule},
      on_told([](Moment& moment, const Action&, Notice& notice) {
        auto* const clock = std::get_if<machine::Clock>(&notice);
        const bool set = moment.is(Role::kMote) && is_member(moment);
        if (clock != nullptr && set) {
          clock->ms = moment.state.clock_offset_ms + moment.state.join.accepted * 1000 / 1024;
        }
        return Fate::kKeep;
      }));
  add(out, "two_islands", "A member acks the reply of a second island, too.",
      {"J7-CHOICE"_rule, "J4-JOINED"_rule}, always([](Moment& moment) {
        const Frame* const frame = moment.heard();
        const bool second = frame != nullptr && is_reply_for(moment, *frame) && is_member(moment);
        const machine::JoinMote before = moment.state.join;
        if (second) {
          moment.state.join.phase = Phase::kJoining;
          moment.state.join.seq_num = get(*frame, join_reply::kSeqNum);
        }
        moment.honest();
        if (!second) return;
        moment.state.join = before;
        moment.rewrite([&](const Action& action) {
          if (action.what != Action::What::kNotify) moment.keep(action);
        });
      }));
}

// The link ack of ack_join.

struct Confirmed {
  Transmit ack;
};

void repeats_late(Moment& moment, Confirmed& memory) {
  moment.honest();
  for (const Transmit& frame : moment.actions.transmits()) {
    if (frame.type == am::kAckJoin) memory.ack = frame;
  }
  const bool asked =
      moment.called<machine::GetClock>() != nullptr || moment.heard(am::kNet) != nullptr;
  if (memory.ack.type != am::kAckJoin || !asked) return;
  moment.actions.transmit("J4-REPEAT"_rule) = memory.ack;
}

void add_repeats(Mutants& out) {
  add(out, "ack_join_repeated_too_often", "An unconfirmed ack_join is sent thirty times.",
      {"J4-REPEAT"_rule, "J4-FEW"_rule}, with_profile(&machine::Profile::ack_join_max, 30));
  add(out, "ack_join_repeated_changed", "The repeats of ack_join have other numbers.",
      {"J4-REPEAT"_rule}, edit_sent([](Moment& moment, Transmit& frame) {
        if (frame.type == am::kAckJoin && moment.state.join.acks > 1) {
          put(frame, ack_join::kSeqNum,
              get(frame, ack_join::kSeqNum) + unsigned{moment.state.join.acks});
        }
      }));
  add(out, "ack_join_repeated_late", "A member sends its ack_join again much later.",
      {"J4-REPEAT"_rule, "J4-JOINED"_rule, "J7-CHOICE"_rule, "J8-JOINED"_rule},
      remembering<Confirmed>(repeats_late));
}

}  // namespace

Mutants mote_accept_mutants() {
  Mutants out;
  add_acceptance(out);
  add_repeats(out);
  return out;
}

}  // namespace rubric::mutants
