// MoteJoins: ack_join, and the joined events of a mote's application. See mote_join.h.
#include <algorithm>

#include "conformance/check/judge/mote_join.h"
#include "conformance/check/links.h"

namespace rubric::check {

using machine::JoinMote;
using Phase = JoinMote::Phase;

namespace {

constexpr std::uint8_t kFewAcks = 5;
constexpr std::int64_t kRecentUs = 1'000'000;

AckJoin expected_ack(const MoteHypothesis& h) {
  return {
      {h.join.address.pid, h.join.sink_devid}, h.join.address, h.join.seq_num, h.join.descriptor};
}

std::string ack_text(const AckJoin& ack) {
  return "dest " + text_of(ack.dest) + ", src " + text_of(ack.src) + ", number " +
         number(ack.seq_num) + ", descriptor " + number(ack.descriptor.mote_type) + "/" +
         number(ack.descriptor.transducers) + "/" + number(ack.descriptor.actuators);
}

}  // namespace

// Returns the known sink of that island; kNobody if there is none.
std::uint16_t MoteJoins::sink_of(std::uint16_t island) const {
  const auto sink =
      std::find_if(context_.sinks.begin(), context_.sinks.end(),
                   [&](std::uint16_t device) { return context_.device(device).island == island; });
  return sink == context_.sinks.end() ? kNobody : *sink;
}

// Returns the rule that forbids this ack_join to the hypothesis; kNone if it is allowed.
ReqId MoteJoins::why_not_ack(const MoteHypothesis& h, const Observation& seen,
                             const AckJoin& ack) const {
  if (h.unknown) return ReqId::kNone;
  if (h.join.phase != Phase::kMember) return "J4-JOINED"_rule;
  AckJoin want = expected_ack(h);
  // If the call began before the capture only a part of it is known.
  if (h.join.seq_num == 0) want.seq_num = ack.seq_num, want.descriptor = ack.descriptor;
  if (h.join.seq_num == 0 || h.join.sink_devid == 0) want.dest = ack.dest;
  if (ack != want) {
    return ack.dest.pid != want.dest.pid && ack.seq_num == want.seq_num ? "J7-CHOICE"_rule
                                                                        : "J4-CONTENT"_rule;
  }
  if (seen.frame.dest != context_.sink_am) return "J4-CONTENT"_rule;
  if (h.acks_seen == 0 || !seen.place.timed()) return ReqId::kNone;
  const std::int64_t last = std::max(h.last_request_us, h.accepted_us + context_.response_us());
  const std::int64_t whole_us = last + kAirMaxUs;  // The mote counts from the end of the frame.
  if (seen.place.time_us > whole_us + context_.join_period_us() + context_.early_us()) {
    return "J4-REPEAT"_rule;
  }
  return h.acks_seen > kAckJoinsMax ? "J4-REPEAT"_rule : ReqId::kNone;
}

void MoteJoins::ack_join(std::uint16_t mote, const Observation& seen, const AckJoin& ack,
                         bool confirmed) {
  MoteWatch& watch = motes_[mote];
  next_.clear();
  for (const MoteHypothesis& h : watch.set) {
    if (why_not_ack(h, seen, ack) != ReqId::kNone) continue;
    MoteHypothesis next = h;
    if (h.unknown) {
      next.join.phase = Phase::kMember;
      next.join.address = ack.src;
      next.join.sink_devid = ack.dest.devid;
      next.join.seq_num = ack.seq_num;
      next.join.descriptor = ack.descriptor;
      next.accepted_us = seen.place.time_us;
      next.unknown = false;
    }
    if (next.acks_seen < 255) ++next.acks_seen;
    next.acked_us = seen.place.time_us;
    next.confirmed = next.confirmed || confirmed;
    next_.push_back(next);
  }
  if (next_.empty()) {
    refuse_ack(mote, seen, ack);
    return;
  }
  const std::uint8_t count = next_[0].acks_seen;
  context_.findings.kept(count > 1 ? "J4-REPEAT"_rule : "J4-CONTENT"_rule);
  context_.findings.kept("J4-SEQ"_rule);
  context_.findings.kept("J7-CHOICE"_rule);
  if (count == kFewAcks + 2) {  // The first and five repeats are fine.
    context_.report(
        "J4-FEW"_rule, Severity::kWeak, seen.place, mote,
        {"The " + number(count) + "th ack_join of one join.", "At most five repeats.", {}});
  }
  watch.wrong_reply.reset();
  keep(watch, next_, mote, seen);
}

void MoteJoins::refuse_ack(std::uint16_t mote, const Observation& seen, const AckJoin& ack) {
  MoteWatch& watch = motes_[mote];
  const std::int64_t now = seen.place.time_us;
  const MoteHypothesis& h = watch.set.back();
  ReqId rule = why_not_ack(h, seen, ack);
  Said said;
  for (auto it = watch.set.rbegin(); it != watch.set.rend(); ++it) {
    said.hypotheses.push_back({sentence(*it), allows(*it), "ack_join with " + ack_text(ack) + "."});
  }
  Severity severity = Severity::kFail;
  if (rule == "J4-REPEAT"_rule) {
    said.text = "The same ack_join again, " + ms_text(now - h.accepted_us) + " after the reply.";
    said.expected =
        "Repeats within one join period (" + ms_text(context_.join_period_us()) + "), at most 20.";
  } else if (h.join.phase == Phase::kMember) {
    said.text =
        "ack_join has " + ack_text(ack) + ", to AM address " + number(seen.frame.dest) + ".";
    said.expected = ack_text(expected_ack(h)) + ", to AM address " + number(context_.sink_am) + ".";
    // Another sink's offer, or a request with another number, may have escaped.
    if (rule == "J7-CHOICE"_rule && h.acks_seen == 0) {
      severity = context_.without(sink_of(ack.dest.pid), h.first_request_us, now);
    } else if (ack.seq_num != h.join.seq_num) {
      const bool asked_so = std::any_of(watch.set.begin(), watch.set.end(), [&](const auto& other) {
        return other.join.phase == Phase::kJoining && other.join.seq_num == ack.seq_num;
      });
      const bool elsewhere = ack.dest.pid != h.join.address.pid;  // A mote with the same id there.
      severity = context_.without(asked_so || elsewhere ? kNobody : mote, h.last_request_us, now);
    }
  } else {
    // It acks a reply that it should not have accepted; the last replies may show which.
    const bool recent = watch.wrong_reply && now - watch.wrong_place.time_us <= kRecentUs;
    const bool asked = h.join.phase == Phase::kJoining;
    const bool own = asked && ack.seq_num == h.join.seq_num &&
                     ack.descriptor == h.join.descriptor && ack.src.pid == ack.dest.pid &&
                     ack.dest.devid == context_.sink_am;
    rule = recent && asked ? "J4-SEQ"_rule : own || !asked ? "J4-JOINED"_rule : "J4-CONTENT"_rule;
    said.text = "ack_join with " + ack_text(ack);
    if (recent) {
      said.text += ", " + ms_text(now - watch.wrong_place.time_us) + " after a reply with number " +
                   number(watch.wrong_reply->seq_num) + ", island " +
                   number(watch.wrong_reply->island);
    } else {
      said.text += ", but no reply was heard that it could accept";
    }
    said.text += asked ? "; its request has number " + number(h.join.seq_num) + "." : ".";
    said.expected = asked ? "No ack_join but to a reply with number " + number(h.join.seq_num) + "."
                          : "No ack_join without a request.";
    // One that fits its own request could answer a right reply that nobody captured.
    if (asked && ack.seq_num != h.join.seq_num) {  // Its own, asked anew.
      severity = context_.without(mote, h.last_request_us, now);
    }
    if (own) severity = context_.without(kNobody, h.first_request_us, now);
    if (!asked) severity = context_.without(mote, context_.device(mote).first_us, now);
    if (!asked && h.first_request_us == 0) severity = context_.without_ever(mote, now);
  }
  context_.report(rule, severity, seen.place, mote, std::move(said));
  // From now on it takes itself for a member; and it may still be asking.
  MoteHypothesis next = h;
  if (rule == "J4-REPEAT"_rule) {
    next.accepted_us = now;  // One finding for each late repeat.
    watch.set.assign(1, next);
    return;
  }
  MoteHypothesis unknown;
  unknown.unknown = true;
  unknown.unaccepted = severity == Severity::kFail && h.join.phase == Phase::kJoining;
  watch.set.assign(1, unknown);
}

void MoteJoins::called(std::uint16_t mote, const Observation& seen,
                       const machine::JoinIsland& call) {
  MoteWatch& watch = motes_[mote];
  // A member, and one whose earlier call is open, refuses at once.
  watch.refusable = watch.joined_calls > 0 ||
                    std::any_of(watch.set.begin(), watch.set.end(), [](const MoteHypothesis& h) {
                      return h.unknown || h.join.phase != Phase::kOutside;
                    });
  ++watch.joined_calls;
  watch.call = call;
  watch.called = seen.place;
  watch.called_us = seen.place.time_us;
}

void MoteJoins::told(std::uint16_t mote, const Observation& seen, const machine::Joined& joined) {
  MoteWatch& watch = motes_[mote];
  const std::int64_t now = seen.place.time_us;
  if (watch.calls_logged && watch.joined_calls == 0) {
    context_.report("J5-ONCE"_rule, Severity::kFail, seen.place, mote,
                    {std::string("joined(") + (joined.success ? "SUCCESS" : "FAIL") +
                         ") although no joinIsland call is open.",
                     "One joined event for each call.",
                     {}});
  }
  if (watch.joined_calls > 0) --watch.joined_calls;
  const std::vector<MoteHypothesis> before = watch.set;
  Said said;
  for (auto it = before.rbegin(); it != before.rend(); ++it) {
    said.hypotheses.push_back({sentence(*it), allows(*it), ""});
  }
  if (joined.success) {
    std::erase_if(watch.set, [&](const MoteHypothesis& h) {
      if (h.unaccepted) return true;
      return !h.unknown && (h.join.phase != Phase::kMember || h.join.address != joined.address);
    });
    const auto joined_before = [&](const MoteHypothesis& h) {
      return !h.unknown && h.told && watch.called_us > h.accepted_us;
    };
    if (watch.call && !watch.set.empty() && std::ranges::all_of(watch.set, joined_before)) {
      context_.report("J8-JOINED"_rule, Severity::kFail, seen.place, mote,
                      {"joined(" + text_of(joined.address) +
                           ", SUCCESS) for a call of joinIsland while the mote was a member.",
                       "joined(FAIL), at once.",
                       {}});
      return;
    }
    for (MoteHypothesis& h : watch.set) h.told = true;
    if (!watch.set.empty()) {
      context_.findings.kept("J5-SUCCESS"_rule);
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
    const bool wrong = h.unaccepted || (watch.wrong_reply.has_value() && foreign);
    context_.report(
        member ? "J5-SUCCESS"_rule : "J5-ACCEPT"_rule,
        member || wrong ? Severity::kFail : context_.without(kNobody, h.first_request_us, now),
        seen.place, mote, std::move(said));
    watch.set = before;
    return;
  }
  // FAIL at once is right for a call while joined (J8-JOINED) or while another call runs.
  const bool refused =
      watch.call && watch.refusable && now - watch.called_us <= context_.response_us();
  const auto fits = [&](const MoteHypothesis& h) {
    return h.unknown || h.join.phase == Phase::kOutside || may_have_failed(h, now);
  };
  if (refused || std::any_of(before.begin(), before.end(), fits)) {
    context_.findings.kept("J8-FAIL"_rule);
    if (!refused) {
      for (MoteHypothesis& h : watch.set) h.join = JoinMote{};
      watch.set.resize(1);
    }
    return;
  }
  said.text = "joined(FAIL) " + ms_text(now - before.back().first_request_us) +
              " after the first join_request.";
  said.expected = "Not before the fourth expiry of the timer, " +
                  ms_text(kExpiriesMin * context_.join_period_us()) + ".";
  context_.report("J8-FAIL"_rule, Severity::kFail, seen.place, mote, std::move(said));
}

// Judges a call of joinIsland that by a log is still open at its end, of a mote that is a member.
void MoteJoins::judge_unsaid(std::uint16_t mote, const MoteWatch& watch, std::int64_t end_us) {
  const MoteHypothesis& h = watch.set[0];
  if (!watch.call || watch.joined_calls == 0 || !context_.run.has_time) return;
  if (!context_.device(mote).hearing) return;  // A log of the application alone may end before.
  const bool again = watch.called_us > h.accepted_us;  // While it was a member.
  // Unconfirmed, the call may wait for the end of all its requests, and fail (decision 102).
  const std::int64_t expiries = context_.profile().join_requests_max * context_.join_period_us();
  const std::int64_t from =
      again ? watch.called_us : std::max(h.first_request_us + expiries, h.acked_us);
  if (end_us <= context_.due_us(mote, from)) return;
  const ReqId rule = again ? "J8-JOINED"_rule : "J5-SUCCESS"_rule;
  Place at = watch.called;
  context_.report(
      rule, Severity::kFail, at, mote,
      {again ? std::string("joinIsland of a mote that is joined ended without an event.")
             : "The mote accepted the address " + text_of(h.join.address) +
                   " and its application is told nothing.",
       again ? "joined(FAIL), at once." : "joined(" + text_of(h.join.address) + ", SUCCESS).",
       {}});
}

void MoteJoins::finish(std::int64_t end_us) {
  for (std::size_t i = 0; i < motes_.size(); ++i) {
    const MoteWatch& watch = motes_[i];
    const Device& device = context_.device(static_cast<std::uint16_t>(i));
    if (device.role != machine::Role::kMote || !device.application || watch.set.size() != 1) {
      continue;
    }
    const MoteHypothesis& h = watch.set[0];
    const std::int64_t expiries = context_.profile().join_requests_max * context_.join_period_us();
    const std::int64_t last = h.first_request_us + expiries + context_.response_us();
    if (!h.unknown && h.join.phase == Phase::kMember) {
      judge_unsaid(static_cast<std::uint16_t>(i), watch, end_us);
    }
    if (h.unknown || h.join.phase != Phase::kJoining || end_us <= last) continue;
    if (h.first_request_us < 0) continue;                         // The begin is unknown.
    if (watch.calls_logged && watch.joined_calls == 0) continue;  // It had its event.
    Place at;
    at.time_us = h.first_request_us;
    context_.report("J8-FAIL"_rule, Severity::kFail, at, static_cast<std::uint16_t>(i),
                    {"The join that began at " + ms_text(h.first_request_us) + " with number " +
                         number(h.join.seq_num) + " ended without any joined event.",
                     "joined(FAIL), not later than the fifth expiry.",
                     {}});
  }
}

}  // namespace rubric::check
