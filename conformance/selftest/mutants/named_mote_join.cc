// Mistakes of motes in joining: requests, how a call ends, what comes from outside; which
// join_reply they accept, what they do with it, ack_join.

#include <algorithm>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using Phase = machine::JoinMote::Phase;
using machine::Joined;
using machine::JoinIsland;
using machine::TimerKind;

Transmit& send_request(Moment& moment) {
  Transmit& request = moment.send(Link::kRadio, am::kJoin, 1, "J1-REQUEST"_rule);
  request.size_bytes = rubicon::JoinRequestView::kMaxSizeBytes;
  put(request, join_request::kSeqNum, moment.state.join.seq_num);
  const machine::Descriptor& d = moment.state.join.descriptor;
  request.payload[join_request::kMoteType] = d.mote_type;
  put(request, join_request::kTransducers, d.transducers);
  request.payload[join_request::kActuators] = d.actuators;
  return request;
}

// Request.

void add_requests(Mutants& out) {
  add(out, "request_without_descriptor", "A mote's join_request has an empty descriptor.",
      {"J1-REQUEST"_rule}, edit_sent(am::kJoin, [](Moment&, Transmit& frame) {
        std::fill_n(frame.payload.begin() + join_request::kMoteType,
                    rubicon::MoteDescView::kMaxSizeBytes, 0);
      }));
  add(out, "request_transducers_cut", "The transducers of a join_request are cut to a byte.",
      {"J1-REQUEST"_rule},
      sent_field(am::kJoin, join_request::kTransducers,
                 [](const Moment&, unsigned v) { return v & 0xFF; }));
  add(out, "request_transducers_swapped", "The transducers have the wrong byte order.",
      {"J1-REQUEST"_rule},
      sent_field(am::kJoin, join_request::kTransducers,
                 [](const Moment&, unsigned v) { return v >> 8 | (v & 0xFF) << 8; }));
  add(out, "request_broadcast", "A join_request goes to everybody.",
      {"J1-DEST"_rule, "J1-REQUEST"_rule},
      edit_sent(am::kJoin, [](Moment&, Transmit& frame) { frame.dest = machine::kAmBroadcast; }));
  add(out, "request_also_to_another_sink", "A join_request goes to a second address, too.",
      {"J1-DEST"_rule}, after_step([](Moment& moment) {
        if (moment.called<JoinIsland>() == nullptr || !is_joining(moment)) return;
        send_request(moment).dest = 2;
      }));
  add(out, "same_number_for_each_call", "Every joinIsland call uses the same number.",
      {"J1-SEQ"_rule}, always([](Moment& moment) {
        const bool again =
            moment.called<JoinIsland>() != nullptr && moment.state.join.requests != 0;
        const std::uint16_t before = moment.state.join.seq_num;
        moment.honest();
        if (!again) return;
        moment.state.join.seq_num = before;
        moment.rewrite([&](const Action& action) {
          if (action.what != Action::What::kTransmit) return moment.keep(action);
          Transmit frame = moment.sent(action);
          if (frame.type == am::kJoin) put(frame, join_request::kSeqNum, before);
          moment.keep(action, frame);
        });
      }));
  add(out, "joins_uncalled", "A mote that hears a sink's join_reply asks to join by itself.",
      {"J1-CALLED"_rule}, after_step([](Moment& moment) {
        const Frame* const reply = moment.heard(am::kJoinReply);
        if (reply == nullptr || !moment.is(Role::kMote)) return;
        if (moment.state.join.phase == Phase::kOutside) send_request(moment);
      }));
  add(out, "request_twice", "Each join_request is sent twice.",
      {"J8-PERIOD"_rule, "J1-REQUEST"_rule},
      double_sent([](const Moment&, const Transmit& frame) { return frame.type == am::kJoin; }));
}

// The end of a call.

void succeeds_twice(Moment& moment) {
  const auto* done = std::get_if<machine::SendDone>(&moment.event);
  const bool confirmed =
      done != nullptr && done->acked && is_member(moment) && moment.state.radio.sending_ack_join;
  moment.honest();
  if (confirmed) moment.actions.notify(Joined{own(moment), true}, "J5-ONCE"_rule);
}

void add_join_ends(Mutants& out) {
  add(out, "joined_with_own_id_only", "joined(SUCCESS) has an address without the island.",
      {"J5-SUCCESS"_rule}, edit_told<Joined>([](Moment&, Joined& joined) {
        if (joined.success) joined.address.pid = 0;
      }));
  add(out, "joined_silently", "joined(SUCCESS) is never signalled.",
      {"J5-SUCCESS"_rule, "J5-ONCE"_rule}, on_told_of<Joined>([](Moment&, Joined& joined) {
        return joined.success ? Fate::kDrop : Fate::kKeep;
      }));
  add(out, "joined_twice", "joined(SUCCESS) comes at acceptance and at the link ack.",
      {"J5-ONCE"_rule}, always(succeeds_twice));
  add(out, "joined_at_once", "A mote calls itself joined when it has asked.", {"J5-ACCEPT"_rule},
      after_step([](Moment& moment) {
        if (moment.called<JoinIsland>() == nullptr || !is_joining(moment)) return;
        moment.actions.notify(Joined{{11, moment.state.config.id}, true}, "J5-ACCEPT"_rule);
      }));
  add(out, "member_keeps_asking", "The join timer of a member runs on and asks again.",
      {"J5-STOP"_rule}, after_step([](Moment& moment) {
        if (moment.heard(am::kNet) != nullptr && is_member(moment)) send_request(moment);
        if (moment.called<JoinIsland>() != nullptr && is_member(moment)) send_request(moment);
      }));
  add(out, "waiting_request_leaves", "A request that waits when a reply comes leaves all the same.",
      {"J5-STOP"_rule}, always([](Moment& moment) {
        auto& queue = moment.state.radio.out;
        const bool waits = !queue.empty() && queue.front().type == am::kJoin;
        const machine::Buffered request = waits ? queue.front() : machine::Buffered{};
        moment.honest();
        if (!waits || !is_member(moment) || queue.full() || moment.heard() == nullptr) return;
        queue.push();
        for (std::size_t i = queue.size() - 1; i > 0; --i) queue[i] = queue[i - 1];
        queue.front() = request;
      }));
  add(out, "fail_twice", "joined(FAIL) is signalled twice.", {"J5-ONCE"_rule},
      on_told_of<Joined>(
          [](Moment&, Joined& joined) { return joined.success ? Fate::kKeep : Fate::kTwice; }));
  add(out, "fail_as_success", "A call that had no success ends in joined(SUCCESS).",
      {"J8-FAIL"_rule, "J5-ACCEPT"_rule},
      edit_told<Joined>([](Moment&, Joined& joined) { joined.success = true; }));
  add(out, "member_joins_again", "joinIsland of a member leaves the island and asks anew.",
      {"J8-JOINED"_rule}, before_step([](Moment& moment) {
        if (moment.called<JoinIsland>() != nullptr && is_member(moment)) {
          moment.state.join.phase = Phase::kOutside;
        }
      }));
  add(out, "member_join_is_success", "joinIsland of a member ends in joined(SUCCESS).",
      {"J8-JOINED"_rule}, edit_told<Joined>([](Moment& moment, Joined& joined) {
        if (moment.called<JoinIsland>() != nullptr && is_member(moment)) joined.success = true;
      }));
}

// The timer.

void add_timer(Mutants& out) {
  add(out, "no_retry", "A mote asks once, and then waits for the end.", {"J8-RETRY"_rule},
      drop_sent([](const Moment& moment, const Transmit& frame) {
        return frame.type == am::kJoin && moment.timer(TimerKind::kJoin);
      }));
  add(out, "one_retry_too_many", "A mote sends six join_requests.", {"J8-LIMIT"_rule},
      with_profile([](machine::Profile& profile) { ++profile.join_requests_max; }));
  add(out, "two_retries_too_few", "A mote gives up after three join_requests.",
      {"J8-FAIL"_rule, "J8-RETRY"_rule}, with_profile(&machine::Profile::join_requests_max, 3));
  add(out, "timer_too_short", "The join timer takes 400 ticks.", {"J8-PERIOD"_rule},
      with_profile(&machine::Profile::join_period_ticks, 400));
  add(out, "timer_too_long", "The join timer takes a second and a half.",
      {"J8-RETRY"_rule, "J8-FAIL"_rule}, with_profile(&machine::Profile::join_period_ticks, 1500));
  add(out, "retries_for_ever", "A mote asks until somebody answers.",
      {"J8-LIMIT"_rule, "J8-FAIL"_rule}, with_profile(&machine::Profile::join_requests_max, 200));
  add(out, "fail_early", "joined(FAIL) comes with the first expiry, and the retries go on.",
      {"J8-FAIL"_rule, "J5-ONCE"_rule}, after_step([](Moment& moment) {
        const bool first =
            moment.timer(TimerKind::kJoin) && is_joining(moment) && moment.state.join.requests == 2;
        if (first) {
          moment.actions.notify(Joined{{0, moment.state.config.id}, false}, "J8-FAIL"_rule);
        }
      }));
}

// Others' business, and life outside.

void stale_address(Moment& moment, machine::Address& first) {
  moment.honest();
  if (!moment.is(Role::kMote)) return;
  if (is_member(moment) && first.pid == 0) first = own(moment);
  moment.rewrite([&](const Action& action) {
    if (action.what != Action::What::kTransmit) return moment.keep(action);
    Transmit frame = moment.sent(action);
    if (is_send(moment, frame)) {
      put(frame, net::kSrcPid, first.pid);
      put(frame, net::kSrcDevid, first.devid);
    }
    moment.keep(action, frame);
  });
}

void add_outside(Mutants& out) {
  add(out, "mote_answers_requests", "A mote answers the join_request of another mote.",
      {"J10-MOTE"_rule}, after_step([](Moment& moment) {
        const Frame* const request = moment.heard(am::kJoin);
        if (request == nullptr || !moment.is(Role::kMote)) return;
        Transmit& reply = moment.send(Link::kRadio, am::kJoinReply, request->src, "J10-MOTE"_rule);
        reply.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
        put(reply, join_reply::kMote, request->src);
      }));
  add(out, "mote_lists_members", "A mote signals moteJoined for an ack_join.", {"J10-MOTE"_rule},
      after_step([](Moment& moment) {
        const Frame* const ack = moment.heard(am::kAckJoin);
        if (ack == nullptr || !moment.is(Role::kMote)) return;
        moment.actions.notify(machine::MoteJoined{{11, ack->src}, {}}, "J10-MOTE"_rule);
      }));
  add(out, "sends_outside", "A mote that has not joined sends from island 0.", {"J11-SEND"_rule},
      always([](Moment& moment) {
        const bool outside = moment.is(Role::kMote) && !is_member(moment) &&
                             moment.called<machine::Send>() != nullptr;
        const Phase before = moment.state.join.phase;
        if (outside) moment.state.join.phase = Phase::kMember;
        moment.honest();
        if (outside) moment.state.join.phase = before;
      }));
  add(out, "hears_outside", "A mote that has not joined takes what names its devid.",
      {"J11-HEAR"_rule}, always([](Moment& moment) {
        const Frame* const frame = moment.heard();
        const bool outside =
            moment.is(Role::kMote) && !is_member(moment) && frame != nullptr && is_net(*frame);
        const machine::JoinMote before = moment.state.join;
        if (outside) {
          moment.state.join.phase = Phase::kMember;
          moment.state.join.address = {get(*frame, net::kDestPid), moment.state.config.id};
        }
        moment.honest();
        if (outside) moment.state.join = before;
      }));
  add(out, "stale_address_kept",
      "A mote that joins another island after a reboot sends from its old address.",
      {"N1-SRC"_rule, "J7-ONE"_rule}, remembering<machine::Address>(stale_address));
}

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
        if (moment.heard(am::kJoinReply) != nullptr) moment.state.clock_offset_ms = offset;
      }));
  add(out, "clock_in_32_bits", "A mote's clock counts microseconds in 32 bits.", {"J4-CLOCK"_rule},
      edit_told<machine::Clock>([](Moment& moment, machine::Clock& clock) {
        constexpr std::uint32_t kRoundMs = 4'294'967;  // 2^32 us.
        const std::uint32_t start = moment.state.clock_offset_ms;
        clock.ms = start + (clock.ms - start) % kRoundMs;
      }));
  add(out, "clock_of_its_own_after_a_reboot", "A mote that starts again keeps its own clock.",
      {"J4-CLOCK"_rule}, remembering<bool>([](Moment& moment, bool& again) {
        again = again || std::holds_alternative<machine::Reboot>(moment.event);
        const std::uint32_t offset_ms = moment.state.clock_offset_ms;
        moment.honest();
        if (again && moment.heard(am::kJoinReply)) moment.state.clock_offset_ms = offset_ms;
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

void mote_join_mutants(Mutants& out) {
  add_requests(out);
  add_join_ends(out);
  add_timer(out);
  add_outside(out);
}

void mote_accept_mutants(Mutants& out) {
  add_acceptance(out);
  add_repeats(out);
}

}  // namespace rubric::mutants
