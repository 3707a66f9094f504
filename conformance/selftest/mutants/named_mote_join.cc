// Mistakes of motes in joining: requests, how a call ends, what comes from outside.
#include <algorithm>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::Joined;
using machine::JoinIsland;
using machine::TimerKind;
using Phase = machine::JoinMote::Phase;

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
  out.push_back({"request_without_descriptor",
                 "A mote's join_request has an empty descriptor.",
                 {"J1-REQUEST"_rule},
                 on_sent([](Moment&, const Action&, Transmit& frame) {
                   if (frame.type == am::kJoin) {
                     std::fill_n(frame.payload.begin() + join_request::kMoteType,
                                 rubicon::MoteDescView::kMaxSizeBytes, 0);
                   }
                   return Fate::kKeep;
                 })});
  out.push_back({"request_transducers_cut",
                 "The transducers of a join_request are cut to a byte.",
                 {"J1-REQUEST"_rule},
                 sent_field(am::kJoin, join_request::kTransducers,
                            [](const Moment&, unsigned v) { return v & 0xFF; })});
  out.push_back({"request_transducers_swapped",
                 "The transducers have the wrong byte order.",
                 {"J1-REQUEST"_rule},
                 sent_field(am::kJoin, join_request::kTransducers,
                            [](const Moment&, unsigned v) { return v >> 8 | (v & 0xFF) << 8; })});
  out.push_back({"request_broadcast",
                 "A join_request goes to everybody.",
                 {"J1-DEST"_rule, "J1-REQUEST"_rule},
                 on_sent([](Moment&, const Action&, Transmit& frame) {
                   if (frame.type == am::kJoin) frame.dest = machine::kAmBroadcast;
                   return Fate::kKeep;
                 })});
  out.push_back({"request_also_to_another_sink",
                 "A join_request goes to a second address, too.",
                 {"J1-DEST"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   if (moment.called<JoinIsland>() == nullptr || !is_joining(moment)) return;
                   send_request(moment).dest = 2;
                 })});
  out.push_back({"same_number_for_each_call",
                 "Every joinIsland call uses the same number.",
                 {"J1-SEQ"_rule},
                 always([](Moment& moment) {
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
                 })});
  out.push_back({"joins_uncalled",
                 "A mote that hears a sink's join_reply asks to join by itself.",
                 {"J1-CALLED"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const reply = moment.heard(am::kJoinReply);
                   if (reply == nullptr || !moment.is(Role::kMote)) return;
                   if (moment.state.join.phase == Phase::kOutside) send_request(moment);
                 })});
  out.push_back(
      {"request_twice",
       "Each join_request is sent twice.",
       {"J8-PERIOD"_rule, "J1-REQUEST"_rule},
       double_sent([](const Moment&, const Transmit& frame) { return frame.type == am::kJoin; })});
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
  out.push_back({"joined_with_own_id_only",
                 "joined(SUCCESS) has an address without the island.",
                 {"J5-SUCCESS"_rule},
                 on_told_of<Joined>([](Moment&, Joined& joined) {
                   if (joined.success) joined.address.pid = 0;
                   return Fate::kKeep;
                 })});
  out.push_back({"joined_silently",
                 "joined(SUCCESS) is never signalled.",
                 {"J5-SUCCESS"_rule, "J5-ONCE"_rule},
                 on_told_of<Joined>([](Moment&, Joined& joined) {
                   return joined.success ? Fate::kDrop : Fate::kKeep;
                 })});
  out.push_back({"joined_twice",
                 "joined(SUCCESS) comes at acceptance and at the link ack.",
                 {"J5-ONCE"_rule},
                 always(succeeds_twice)});
  out.push_back(
      {"joined_at_once",
       "A mote calls itself joined when it has asked.",
       {"J5-ACCEPT"_rule},
       always([](Moment& moment) {
         moment.honest();
         if (moment.called<JoinIsland>() == nullptr || !is_joining(moment)) return;
         moment.actions.notify(Joined{{11, moment.state.config.id}, true}, "J5-ACCEPT"_rule);
       })});
  out.push_back({"member_keeps_asking",
                 "The join timer of a member runs on and asks again.",
                 {"J5-STOP"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   if (moment.heard(am::kNet) != nullptr && is_member(moment)) send_request(moment);
                   if (moment.called<JoinIsland>() != nullptr && is_member(moment)) {
                     send_request(moment);
                   }
                 })});
  out.push_back({"fail_twice",
                 "joined(FAIL) is signalled twice.",
                 {"J5-ONCE"_rule},
                 on_told_of<Joined>([](Moment&, Joined& joined) {
                   return joined.success ? Fate::kKeep : Fate::kTwice;
                 })});
  out.push_back({"fail_as_success",
                 "A call that had no success ends in joined(SUCCESS).",
                 {"J8-FAIL"_rule, "J5-ACCEPT"_rule},
                 on_told_of<Joined>([](Moment&, Joined& joined) {
                   joined.success = true;
                   return Fate::kKeep;
                 })});
  out.push_back({"member_joins_again",
                 "joinIsland of a member leaves the island and asks anew.",
                 {"J8-JOINED"_rule},
                 always([](Moment& moment) {
                   if (moment.called<JoinIsland>() != nullptr && is_member(moment)) {
                     moment.state.join.phase = Phase::kOutside;
                   }
                   moment.honest();
                 })});
  out.push_back({"member_join_is_success",
                 "joinIsland of a member ends in joined(SUCCESS).",
                 {"J8-JOINED"_rule},
                 on_told_of<Joined>([](Moment& moment, Joined& joined) {
                   if (moment.called<JoinIsland>() != nullptr && is_member(moment)) {
                     joined.success = true;
                   }
                   return Fate::kKeep;
                 })});
}

// The timer.

void add_timer(Mutants& out) {
  out.push_back({"no_retry",
                 "A mote asks once, and then waits for the end.",
                 {"J8-RETRY"_rule},
                 drop_sent([](const Moment& moment, const Transmit& frame) {
                   return frame.type == am::kJoin && moment.timer(TimerKind::kJoin);
                 })});
  out.push_back({"one_retry_too_many",
                 "A mote sends six join_requests.",
                 {"J8-LIMIT"_rule},
                 with_profile([](machine::Profile& profile) { ++profile.join_requests_max; })});
  out.push_back({"two_retries_too_few",
                 "A mote gives up after three join_requests.",
                 {"J8-FAIL"_rule, "J8-RETRY"_rule},
                 with_profile([](machine::Profile& profile) { profile.join_requests_max = 3; })});
  out.push_back({"timer_too_short",
                 "The join timer takes 400 ticks.",
                 {"J8-PERIOD"_rule},
                 with_profile([](machine::Profile& profile) { profile.join_period_ticks = 400; })});
  out.push_back(
      {"timer_too_long",
       "The join timer takes a second and a half.",
       {"J8-RETRY"_rule, "J8-FAIL"_rule},
       with_profile([](machine::Profile& profile) { profile.join_period_ticks = 1500; })});
  out.push_back({"retries_for_ever",
                 "A mote asks until somebody answers.",
                 {"J8-LIMIT"_rule, "J8-FAIL"_rule},
                 with_profile([](machine::Profile& profile) { profile.join_requests_max = 200; })});
  out.push_back(
      {"fail_early",
       "joined(FAIL) comes with the first expiry, and the retries go on.",
       {"J8-FAIL"_rule, "J5-ONCE"_rule},
       always([](Moment& moment) {
         moment.honest();
         const bool first = moment.timer(TimerKind::kJoin) && is_joining(moment) &&
                            moment.state.join.requests == 2;
         if (first) {
           moment.actions.notify(Joined{{0, moment.state.config.id}, false}, "J8-FAIL"_rule);
         }
       })});
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
  out.push_back({"mote_answers_requests",
                 "A mote answers the join_request of another mote.",
                 {"J10-MOTE"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const request = moment.heard(am::kJoin);
                   if (request == nullptr || !moment.is(Role::kMote)) return;
                   Transmit& reply =
                       moment.send(Link::kRadio, am::kJoinReply, request->src, "J10-MOTE"_rule);
                   reply.size_bytes = rubicon::JoinReplyView::kMaxSizeBytes;
                   put(reply, join_reply::kMote, request->src);
                 })});
  out.push_back({"mote_lists_members",
                 "A mote signals moteJoined for an ack_join.",
                 {"J10-MOTE"_rule},
                 always([](Moment& moment) {
                   moment.honest();
                   const Frame* const ack = moment.heard(am::kAckJoin);
                   if (ack == nullptr || !moment.is(Role::kMote)) return;
                   moment.actions.notify(machine::MoteJoined{{11, ack->src}, {}}, "J10-MOTE"_rule);
                 })});
  out.push_back({"sends_outside",
                 "A mote that has not joined sends from island 0.",
                 {"J11-SEND"_rule},
                 always([](Moment& moment) {
                   const bool outside = moment.is(Role::kMote) && !is_member(moment) &&
                                        moment.called<machine::Send>() != nullptr;
                   const Phase before = moment.state.join.phase;
                   if (outside) moment.state.join.phase = Phase::kMember;
                   moment.honest();
                   if (outside) moment.state.join.phase = before;
                 })});
  out.push_back(
      {"hears_outside",
       "A mote that has not joined takes what names its devid.",
       {"J11-HEAR"_rule},
       always([](Moment& moment) {
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
       })});
  out.push_back({"stale_address_kept",
                 "A mote that joins another island after a reboot sends from its old address.",
                 {"N1-SRC"_rule, "J7-ONE"_rule},
                 remembering<machine::Address>(stale_address)});
}

}  // namespace

Mutants mote_join_mutants() {
  Mutants out;
  add_requests(out);
  add_join_ends(out);
  add_timer(out);
  add_outside(out);
  return out;
}

}  // namespace rubric::mutants
