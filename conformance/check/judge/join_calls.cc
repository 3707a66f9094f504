#include "conformance/check/judge/join_calls.h"

#include <algorithm>
#include <utility>

#include "conformance/check/links.h"

namespace rubric::check {

using machine::JoinMote;
using Phase = JoinMote::Phase;

namespace {

constexpr std::int64_t kConfirmUs = 150'000;  // Golden traces give a link so long to confirm.

}  // namespace

JoinCalls::JoinCalls(Context& context, MoteJoins& motes, std::size_t devices)
    : context_(context), motes_(motes), calls_(devices) {
  // Only a log that has join calls, or is whole, surely shows that there was none.
  for (std::size_t i = 0; i < devices; ++i) {
    calls_[i].logged = calls_[i].recorded = context.device(static_cast<std::uint16_t>(i)).whole;
  }
  for (std::size_t i = 0; i < context.run.seen.size(); ++i) {
    const Observation& seen = context.run.seen[i];
    const std::uint16_t node = context.who.marks[i].device;
    if (seen.kind != Observation::Kind::kCall || node == kNobody) continue;
    calls_[node].recorded = true;
    if (std::holds_alternative<machine::JoinIsland>(*seen.call)) calls_[node].logged = true;
  }
}

void JoinCalls::begin_life(std::uint16_t mote) {
  Calls next;
  next.logged = calls_[mote].logged;
  next.recorded = calls_[mote].recorded;
  calls_[mote] = next;
}

bool JoinCalls::request(std::uint16_t mote, const Observation& seen, const Request& request) {
  Calls& calls = calls_[mote];
  judge_silent(mote, seen.place.time_us);
  calls.asks = false;
  const std::optional<Request> before = std::exchange(calls.asked, request);
  const Place before_at = std::exchange(calls.asked_at, seen.place);
  const bool fresh = std::exchange(calls.fresh, false);
  const std::vector<MoteHypothesis>& set = std::as_const(motes_).set(mote);
  // Its log may have the call, or its end, beside the request that a capture has.
  const std::int64_t now = seen.place.time_us;
  const auto its_call = [&](const Observation& other) {
    return other.kind == Observation::Kind::kCall && other.node == context_.run.nodes[mote].name &&
           std::holds_alternative<machine::JoinIsland>(*other.call);
  };
  const bool beside_log = calls.logged && seen.node.empty();
  const Observation* const later = beside_log ? context_.soon(now, its_call) : nullptr;
  if (calls.recorded && context_.log_begun(mote, now) && calls.open == 0 && set.size() == 1 &&
      !set[0].unknown && set[0].join.phase == Phase::kOutside) {
    const bool open = !calls.logged || later != nullptr ||
                      (beside_log && now - calls.told_us <= context_.options.skew_us);
    context_.report("J1-CALLED"_rule, open ? Severity::kInconclusive : Severity::kFail, seen.place,
                    mote, {"A join_request without a joinIsland call.", "Silence.", {}});
  }
  const bool soon = seen.place.timed() && before_at.timed() &&
                    seen.place.time_us - before_at.time_us <=
                        context_.join_period_us(mote) + context_.response_us(mote);
  if (!calls.logged && soon && before && before->seq_num == request.seq_num &&
      before->descriptor != request.descriptor) {
    context_.report("J1-SEQ"_rule, Severity::kWeak, seen.place, mote,
                    {"The join_request with number " + number(request.seq_num) +
                         " has another descriptor than the one before it.",
                     "A call keeps its descriptor, and the next one takes another number.",
                     {}});
  }
  const bool as_member = calls.last && calls.open > 0 && !set.empty() &&
                         set.back().join.phase == Phase::kMember &&
                         calls.called.time_us > set.back().accepted_us;
  // Only the last call is open; what an earlier one left in a buffer cannot have waited for the
  // line.
  const std::int64_t called_us = calls.called.time_us;
  const bool asked = calls.last && calls.open == 1 &&
                     context_.due_us(mote, called_us) == called_us + context_.response_us(mote);
  const bool numbered = asked && fresh && before && !seen.node.empty();
  if (numbered && before->seq_num == request.seq_num) {
    context_.report("J1-SEQ"_rule, Severity::kWeak, seen.place, mote,
                    {"The first join_request of a joinIsland call has number " +
                         number(request.seq_num) + ", as had those of the call before.",
                     "Another number, which no late reply fits.",
                     {}});
  } else if (numbered) {
    context_.findings.kept("J1-SEQ"_rule);
  }
  if (!asked && (calls.open > 0 || later == nullptr)) return as_member;
  const auto fits = [&](const std::optional<machine::JoinIsland>& call) {
    return call && call->descriptor == request.descriptor;
  };
  if ((asked && (fits(calls.last) || fits(calls.earlier))) ||
      (later != nullptr && fits(std::get<machine::JoinIsland>(*later->call)))) {
    context_.findings.kept("J1-REQUEST"_rule);
  } else {
    context_.report("J1-REQUEST"_rule, Severity::kFail, seen.place, mote,
                    {"A join_request has another descriptor than its joinIsland call.",
                     "The descriptor of the call.",
                     {}});
  }
  return as_member;
}

void JoinCalls::called(std::uint16_t mote, const Observation& seen,
                       const machine::JoinIsland& call) {
  Calls& calls = calls_[mote];
  ends(mote, seen.place.time_us);
  calls.fresh = calls.open == 0;
  if (calls.fresh) motes_.called(mote, seen.place.time_us);
  // A member, and one whose earlier call is open, refuses at once.
  calls.refusable =
      calls.open > 0 || std::ranges::any_of(motes_.set(mote), [](const MoteHypothesis& h) {
        return h.unknown || h.join.phase != Phase::kOutside;
      });
  calls.waits = calls.open > 0;
  // Which of two calls a failure ended is not told.
  if (!calls.waits) calls.earlier.reset();
  if (calls.waits && !calls.earlier) calls.earlier = calls.last;
  if (calls.open == 0) calls.off_us = 0;
  ++calls.open;
  calls.last = call;
  calls.called = seen.place;
  calls.asks = context_.device(mote).whole && !calls.refusable && calls.off_since_us < 0;
}

void JoinCalls::radio_set(std::uint16_t mote, bool on, std::int64_t now_us) {
  judge_silent(mote, now_us);
  Calls& calls = calls_[mote];
  if (calls.off_since_us >= 0) calls.off_us += now_us - calls.off_since_us;
  calls.off_since_us = on ? -1 : now_us;
  calls.asks = false;
}

void JoinCalls::ends(std::uint16_t mote, std::int64_t end_us) {
  judge_over(mote, end_us);
  judge_silent(mote, end_us);
}

// Judges a call that by a whole log no request has followed until `end_us`.
void JoinCalls::judge_silent(std::uint16_t mote, std::int64_t end_us) {
  Calls& calls = calls_[mote];
  if (!calls.asks || !context_.run.has_time) return;
  const std::int64_t called_us = calls.called.time_us;
  const std::int64_t due_us = context_.due_us(mote, called_us, machine::Link::kRadio);
  if (end_us <= due_us) return;
  calls.asks = false;
  // A call may end before the channel is free again.
  const std::int64_t runs_us = motes_.expiries_min(mote) * context_.join_period_us(mote);
  if (due_us > called_us + context_.response_us(mote) && due_us >= called_us + runs_us) return;
  context_.report("J1-REQUEST"_rule, Severity::kFail, calls.called, mote,
                  {"After the call of joinIsland the mote sent no join_request within " +
                       ms_text(context_.response_us(mote)) + ".",
                   "A join_request, to the sinks' address.",
                   {}});
}

void JoinCalls::told(std::uint16_t mote, const Observation& seen, const machine::Joined& joined) {
  Calls& calls = calls_[mote];
  std::vector<MoteHypothesis>& set = motes_.set(mote);
  const std::int64_t now = seen.place.time_us;
  const auto elsewhere = [&](const MoteHypothesis& h) {
    return !h.unknown && h.told && h.join.address.pid != joined.address.pid;
  };
  if (joined.success && calls.open == 0 && !set.empty() && std::ranges::all_of(set, elsewhere)) {
    context_.report("J7-ONE"_rule, Severity::kFail, seen.place, mote,
                    {"joined(" + text_of(joined.address) + ", SUCCESS) of a mote that has joined " +
                         text_of(set.back().join.address) + ".",
                     "One island until it starts anew.",
                     {}});
    return;
  }
  const std::int64_t call_us = context_.join_call_us(mote) + context_.response_us(mote);
  const bool before_log = context_.begun_before(mote, now, call_us);
  if (calls.logged && calls.open == 0) {
    const bool open = before_log || context_.log_late(mote, now, call_us);
    context_.report("J5-ONCE"_rule, open ? Severity::kInconclusive : Severity::kFail, seen.place,
                    mote,
                    {std::string("joined(") + (joined.success ? "SUCCESS" : "FAIL") +
                         ") although no joinIsland call is open.",
                     "One joined event for each call.",
                     {}});
  }
  if (!joined.success) judge_silent(mote, now);
  if (calls.open > 0) --calls.open;
  calls.told_us = now;
  if (calls.open > 0) motes_.called(mote, now);  // One that waited begins.
  motes_.link_told(mote, now);
  const std::vector<MoteHypothesis> before = set;
  Said said;
  said.hypotheses = motes_.explanations(mote, before, "");
  if (joined.success) {
    for (MoteHypothesis& h : set) {
      const bool own = joined.address.devid == context_.device(mote).am;
      if (h.void_offer && own) h.join.address.devid = joined.address.devid;
    }
    std::erase_if(set, [&](const MoteHypothesis& h) {
      if (h.unaccepted) return true;
      return !h.unknown && (h.join.phase != Phase::kMember || h.join.address != joined.address);
    });
    const auto joined_before = [&](const MoteHypothesis& h) {
      return !h.unknown && h.told && calls.called.time_us > h.accepted_us;
    };
    if (calls.last && !set.empty() && std::ranges::all_of(set, joined_before)) {
      context_.report("J8-JOINED"_rule, Severity::kFail, seen.place, mote,
                      {"joined(" + text_of(joined.address) +
                           ", SUCCESS) for a call of joinIsland while the mote was a member.",
                       "joined(FAIL), at once.",
                       {}});
      return;
    }
    motes_.judge_offer(mote, seen.place, set);
    const bool late = judge_late(mote, seen, set);
    for (MoteHypothesis& h : set) h.told = true;
    if (!set.empty()) {
      if (!late) context_.findings.kept("J5-SUCCESS"_rule);
      return;
    }
    const MoteHypothesis& h = before.back();
    const bool member = h.join.phase == Phase::kMember;
    said.text = "joined(" + text_of(joined.address) + ", SUCCESS) is signalled" +
                (member ? ", but the reply gave " + text_of(h.join.address) + "."
                        : " before a reply was accepted.");
    said.expected =
        member ? "The address of the reply." : "Nothing, or FAIL after the last request.";
    const bool foreign = joined.address.devid != context_.device(mote).am;
    const bool wrong = h.unaccepted || (motes_.stray_offer(mote) && foreign);
    // Until its ack_join is seen the reply that it took may be one that escaped.
    const bool known = member && (h.acks_seen > 0 || foreign);
    context_.report(
        member ? "J5-SUCCESS"_rule : "J5-ACCEPT"_rule,
        known || wrong ? Severity::kFail : context_.without(kNobody, h.first_request_us, now, mote),
        seen.place, mote, std::move(said));
    set = before;
    return;
  }
  // A call while joined asks nobody, and FAIL is right at once (J8-JOINED). A call while another
  // one runs may fail at once or later.
  const bool waited = std::exchange(calls.waits, false);
  const bool asks = calls.asked && calls.asked_at.time_us >= calls.called.time_us;
  const bool refused = waited || (calls.last && calls.refusable && !asks &&
                                  now - calls.called.time_us <= context_.response_us(mote));
  const auto fits = [&](const MoteHypothesis& h) {
    return h.unknown || h.join.phase == Phase::kOutside ||
           (!h.linked && motes_.may_have_failed(mote, h, now));
  };
  const auto member = [](const MoteHypothesis& h) {
    return !h.unknown && h.join.phase == Phase::kMember && h.told;
  };
  if (!refused && calls.refusable && context_.device(mote).whole &&
      std::ranges::all_of(before, member) && now > context_.due_us(mote, calls.called.time_us)) {
    context_.report("J8-JOINED"_rule, Severity::kFail, seen.place, mote,
                    {"joined(FAIL) " + ms_text(now - calls.called.time_us) +
                         " after joinIsland of a mote that is joined.",
                     "joined(FAIL), at once.",
                     {}});
    return;
  }
  if (refused || std::any_of(before.begin(), before.end(), fits)) {
    const auto late = [&](const MoteHypothesis& h) {
      return !h.unknown && h.join.phase == Phase::kJoining &&
             now > context_.due_us(mote, last_expiry_us(mote, h));
    };
    if (!refused && context_.device(mote).whole && std::ranges::all_of(before, late)) {
      context_.report("J8-FAIL"_rule, Severity::kFail, seen.place, mote,
                      {"joined(FAIL) " + ms_text(now - before.back().first_request_us) +
                           " after the first join_request.",
                       fails_by(mote),
                       {}});
    }
    context_.findings.kept("J8-FAIL"_rule);
    if (!refused) {
      for (MoteHypothesis& h : set) h.join = JoinMote{};
      set.resize(1);
    }
    return;
  }
  if (before.back().linked) {
    context_.report("J5-SUCCESS"_rule, Severity::kFail, seen.place, mote,
                    {"joined(FAIL), although the link told the mote that its ack_join for " +
                         text_of(before.back().join.address) + " was received.",
                     "joined(" + text_of(before.back().join.address) + ", SUCCESS).",
                     std::move(said.hypotheses)});
    return;
  }
  said.text = "joined(FAIL) " + ms_text(now - before.back().first_request_us) +
              " after the first join_request.";
  const std::uint8_t expiries = motes_.expiries_min(mote);
  said.expected = "Not before expiry " + number(expiries) + " of the timer, " +
                  ms_text(expiries * context_.join_period_us(mote)) + ".";
  said.beyond = true;
  // Of a call that lasted long enough the first requests may have escaped.
  const std::int64_t least_us = expiries * context_.join_period_us(mote) - context_.early_us(mote);
  const bool lasted =
      calls.last && !context_.device(mote).hearing && now - calls.called.time_us >= least_us &&
      (!context_.options.sniffer_complete || context_.before_captures(mote, calls.called.time_us));
  context_.report("J8-FAIL"_rule, before_log || lasted ? Severity::kInconclusive : Severity::kFail,
                  seen.place, mote, std::move(said));
}

// Returns when at the latest the mote had joined: it answers within the response time and may wait
// until its link has confirmed ack_join, or it gives up (decision 102). Once ack_join has left,
// what comes later, a busy channel for one, excuses nothing.
std::int64_t JoinCalls::joined_us(std::uint16_t mote, const MoteHypothesis& h,
                                  std::int64_t now_us) const {
  const bool answered = h.acks_seen > 0 && h.acked_us >= h.accepted_us;
  std::int64_t link_us = -1;
  for (const std::int64_t time_us : context_.run.nodes[mote].link_failures_us) {
    if (time_us <= now_us) link_us = time_us;
  }
  for (const std::int64_t time_us : context_.run.nodes[mote].link_acks_us) {
    if (!answered || time_us < h.acked_us) continue;
    if (time_us <= now_us) link_us = time_us;
    break;
  }
  return std::max(link_us,
                  answered ? h.acked_us + kConfirmUs : h.accepted_us + context_.response_us(mote));
}

// Reports a success that by a whole log is told later than in a golden trace, whichever state of
// `set` the mote was in. Returns whether it was.
bool JoinCalls::judge_late(std::uint16_t mote, const Observation& seen,
                           const std::vector<MoteHypothesis>& set) {
  if (!context_.device(mote).whole || !context_.run.has_time || set.empty()) return false;
  const std::int64_t now = seen.place.time_us;
  for (const MoteHypothesis& h : set) {
    if (h.unknown || h.told) return false;
    if (now <= context_.due_us(mote, joined_us(mote, h, now))) return false;
  }
  const std::int64_t took_us = now - joined_us(mote, set.back(), now);
  context_.report("J5-SUCCESS"_rule, Severity::kFail, seen.place, mote,
                  {"joined(" + text_of(set.back().join.address) + ", SUCCESS) " + ms_text(took_us) +
                       " after the mote had joined.",
                   "When it has joined.",
                   {}});
  return true;
}

// Judges a call of joinIsland that by a log is still open at its end, of a mote that is a member.
void JoinCalls::judge_member(std::uint16_t mote, const MoteHypothesis& h, std::int64_t end_us) {
  const Calls& calls = calls_[mote];
  if (!calls.last || calls.open == 0 || !context_.run.has_time) return;
  const bool again = calls.called.time_us > h.accepted_us;  // While it was a member.
  // Unconfirmed, the call may wait for the end of all its requests, and fail (decision 102).
  // In a whole log it has the time of a golden trace.
  const bool whole = context_.device(mote).whole;
  // What the link tells later than it answers is of another frame.
  const std::int64_t told_us = std::min(end_us, h.acked_us + context_.response_us(mote));
  const std::int64_t over_us =
      whole ? joined_us(mote, h, told_us) : std::max(last_expiry_us(mote, h), h.acked_us);
  const std::int64_t due_us = context_.due_us(mote, again ? calls.called.time_us : over_us);
  if (end_us <= due_us || !context_.tells_any(mote, due_us)) return;
  context_.report(
      again    ? "J8-JOINED"_rule
      : h.told ? "J5-ONCE"_rule
               : "J5-SUCCESS"_rule,
      Severity::kFail, calls.called, mote,
      {again    ? std::string("joinIsland of a mote that is joined ended without an event.")
       : h.told ? std::string("A joinIsland call ended without an event of its own.")
                : "The mote accepted the address " + text_of(h.join.address) +
                      " and its application is told nothing.",
       again || h.told ? "joined(FAIL), at once."
                       : "joined(" + text_of(h.join.address) + ", SUCCESS).",
       {}});
}

// Returns when the timer of a call that may send all its requests expires for the last time. A
// request may be late by the response time, and makes all after it late; so do a busy channel and a
// radio that is off.
std::int64_t JoinCalls::last_expiry_us(std::uint16_t mote, const MoteHypothesis& h) const {
  const std::int64_t period_us = context_.join_period_us(mote);
  const std::int64_t requests = context_.profile(mote).join_requests_max;
  const std::int64_t left = std::max<std::int64_t>(0, requests - h.join.requests);
  const std::int64_t latest_us =
      h.first_request_us + requests * (period_us + context_.response_us(mote));
  std::int64_t over_us = std::max(h.first_request_us + context_.join_call_us(mote),
                                  std::min(latest_us, h.last_request_us + (left + 1) * period_us)) +
                         calls_[mote].off_us;
  for (const BusyTime& busy : context_.busy_times(mote)) {
    const std::int64_t from_us = std::max(busy.from_us, h.first_request_us);
    if (busy.line == machine::Link::kSerial || busy.to_us <= from_us || from_us > over_us) continue;
    if (busy.to_us == INT64_MAX) return INT64_MAX / 2;
    over_us += busy.to_us - from_us + 2 * context_.response_us(mote);
  }
  return over_us;
}

// Returns what a call without an answer ends with.
std::string JoinCalls::fails_by(std::uint16_t mote) const {
  return "joined(FAIL), not later than expiry " + number(context_.profile(mote).join_requests_max) +
         " of the timer.";
}

// Judges a call that by a whole log ran out without an event before the next one.
void JoinCalls::judge_over(std::uint16_t mote, std::int64_t now_us) {
  Calls& calls = calls_[mote];
  const std::vector<MoteHypothesis>& set = std::as_const(motes_).set(mote);
  if (!context_.device(mote).whole || calls.open == 0 || set.empty()) return;
  const auto over = [&](const MoteHypothesis& h) {
    return !h.unknown && h.join.phase == Phase::kJoining &&
           now_us > context_.due_us(mote, last_expiry_us(mote, h));
  };
  if (!std::ranges::all_of(set, over)) return;
  calls.open = 0;
  context_.report("J8-FAIL"_rule, Severity::kFail, calls.called, mote,
                  {"A joinIsland call ended without any joined event.", fails_by(mote), {}});
}

void JoinCalls::closes(std::uint16_t mote, std::int64_t end_us) {
  const Device& device = context_.device(mote);
  judge_silent(mote, end_us);
  if (calls_[mote].off_since_us >= 0) radio_set(mote, true, end_us);  // Counts how long it was off.
  const std::vector<MoteHypothesis>& set = std::as_const(motes_).set(mote);
  const bool known = set.size() == 1 && !set[0].unknown;
  if (device.role != machine::Role::kMote || !device.application || !known) return;
  const MoteHypothesis& h = set[0];
  if (h.join.phase == Phase::kMember) judge_member(mote, h, end_us);
  if (h.join.phase != Phase::kJoining) return;
  if (h.first_request_us < 0) return;                         // The begin is unknown.
  if (calls_[mote].logged && calls_[mote].open == 0) return;  // It had its event.
  const std::int64_t over_us =
      device.whole ? last_expiry_us(mote, h) : h.first_request_us + context_.join_call_us(mote);
  const std::int64_t due_us = context_.due_us(mote, over_us);
  // A log that goes on after the call, and ends before, says nothing.
  const std::int64_t log_end_us = context_.log_end_us(mote);
  const bool ended = log_end_us <= due_us && log_end_us > calls_[mote].called.time_us;
  if (end_us <= due_us || ended) return;
  Place at;
  at.time_us = h.first_request_us;
  context_.report("J8-FAIL"_rule, Severity::kFail, at, mote,
                  {"The join that began at " + ms_text(h.first_request_us) + " with number " +
                       number(h.join.seq_num) + " ended without any joined event.",
                   fails_by(mote),
                   {}});
}

void JoinCalls::finish() {
  for (std::uint16_t i = 0; i < calls_.size(); ++i) closes(i, context_.end_us(i));
}

// What calls and the link tell the hypotheses of a mote.

std::uint8_t MoteJoins::expiries_min(std::uint16_t mote) const {
  return std::min<std::uint8_t>(4, context_.profile(mote).join_requests_max);
}

// Returns the known sink of that island; kNobody if there is none.
std::uint16_t MoteJoins::sink_of(std::uint16_t island) const {
  const auto sink =
      std::find_if(context_.sinks.begin(), context_.sinks.end(),
                   [&](std::uint16_t device) { return context_.device(device).island == island; });
  return sink == context_.sinks.end() ? kNobody : *sink;
}

// Returns whether the offer that the mote accepts was captured out of order: before the request,
// of which only the link's copy was captured, or as such a copy after the ack_join. The first of
// two copies leaves no gap in the DSNs where it is not captured.
bool MoteJoins::may_take_copy(std::uint16_t mote, const MoteHypothesis& h, const AckJoin& ack,
                              std::int64_t now_us) {
  const auto is_offer = [&](const Observation& seen) {
    Reply reply;
    return seen.kind == Observation::Kind::kRadio && seen.frame.type == am::kJoinReply &&
           seen.frame.dest == context_.device(mote).am && parse_reply(seen.frame.payload, reply) &&
           reply.island == ack.src.pid && reply.seq_num == ack.seq_num;
  };
  const std::int64_t before_us = h.last_request_us - kLinkRepeatUs;
  if (context_.next(before_us, kLinkRepeatUs, is_offer) != nullptr) return true;
  if (context_.copies_missed == 0) return false;
  if (context_.next(now_us, kLinkRepeatUs, is_offer) == nullptr) return false;
  --context_.copies_missed;
  return true;
}

std::int64_t MoteJoins::began_us(std::uint16_t mote, const MoteHypothesis& h) const {
  const std::int64_t called_us = motes_[mote].called_us;
  const bool its = called_us >= 0 && called_us < h.first_request_us;
  const bool waited =
      its && context_.busy(mote, called_us, h.first_request_us, machine::Link::kRadio);
  return waited ? called_us : h.first_request_us;
}

bool MoteJoins::may_have_failed(std::uint16_t mote, const MoteHypothesis& h,
                                std::int64_t now_us) const {
  const std::int64_t expiries = expiries_min(mote) * context_.join_period_us(mote);
  return now_us - began_us(mote, h) >= expiries - context_.early_us(mote);
}

void MoteJoins::link_told(std::uint16_t mote, std::int64_t now_us) {
  if (mote >= context_.run.nodes.size()) return;  // A log's nodes are the first devices.
  for (MoteHypothesis& h : motes_[mote].set) {
    if (h.join.phase != Phase::kMember || h.acks_seen == 0) continue;
    const std::int64_t first_us = h.acks_seen == 1 ? h.acked_us : h.accepted_us;
    const std::int64_t last_us = std::min(now_us, h.acked_us + context_.response_us(mote));
    const auto its = [&](std::int64_t at_us) { return at_us >= first_us && at_us <= last_us; };
    h.linked = h.linked || std::ranges::any_of(context_.run.nodes[mote].link_acks_us, its);
  }
}

}  // namespace rubric::check
