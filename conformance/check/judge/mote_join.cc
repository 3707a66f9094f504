#include "conformance/check/judge/mote_join.h"

#include <algorithm>
#include <utility>

#include "conformance/check/links.h"

namespace rubric::check {

using machine::JoinMote;
using machine::JoinSend;
using Phase = JoinMote::Phase;

namespace {

constexpr std::uint8_t kFewAcks = 6;  // The first and five repeats (decision 102).

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

bool is_void(const Reply& reply, std::uint16_t am) {
  return machine::is_reserved(reply.island) || reply.mote != am;
}

MoteJoins::MoteJoins(Context& context, std::size_t devices) : context_(context), motes_(devices) {
  for (std::size_t i = 0; i < devices; ++i) {
    MoteHypothesis start;
    const bool later =  // Its log begins when others have begun.
        i < context.run.nodes.size() && context.run.nodes[i].from_us > context.run.start_us;
    start.unknown = !context.options.start_cold || later;
    motes_[i].set.push_back(start);
  }
}

void MoteJoins::begin_life(std::uint16_t mote) {
  motes_[mote] = MoteWatch{};
  motes_[mote].set.push_back(MoteHypothesis{});
}

// Applies a request to a hypothesis. Returns false if the hypothesis does not allow it.
bool MoteJoins::next_request(std::uint16_t mote, const MoteHypothesis& h, std::int64_t now_us,
                             const Request& request, std::vector<MoteHypothesis>& out) {
  machine::JoinContext join_context = context_.join_context(mote, 0, now_us);
  const auto fresh_call = [&] {
    MoteHypothesis next;
    machine::call_join(next.join, join_context, request.descriptor, request.seq_num,
                       context_.actions);
    next.first_request_us = next.last_request_us = now_us;
    out.push_back(next);
    return true;
  };
  context_.actions.clear();
  if (h.unknown || h.join.phase == Phase::kOutside) return fresh_call();
  // A mote that accepted, but had no link ack, may let its timer run on (decision 102).
  if (h.join.phase == Phase::kMember && (h.sent || h.confirmed || h.linked || h.told)) {
    return false;
  }
  const std::int64_t least_us = context_.join_period_us(mote) - context_.early_us(mote);
  const bool in_time = now_us - h.last_request_us >= least_us;
  bool any = false;
  MoteHypothesis again = h;
  again.join.phase = Phase::kJoining;
  if (in_time &&
      machine::join_timer(again.join, join_context, context_.actions) == JoinSend::kRequest) {
    again.last_request_us = now_us;
    again.renumbered = h.renumbered || request.seq_num != h.join.seq_num;
    again.join.seq_num = request.seq_num;
    out.push_back(again);
    if (h.join.phase == Phase::kMember) {  // It may also repeat its ack_join.
      out.push_back(h);
      out.back().last_request_us = now_us;
      out.back().join.requests = again.join.requests;
    }
    any = true;
  }
  if (request.seq_num != h.join.seq_num && may_have_failed(mote, h, now_us)) any = fresh_call();
  return any;
}

void MoteJoins::request(std::uint16_t mote, const Observation& seen, const Request& request,
                        bool as_member) {
  MoteWatch& watch = motes_[mote];
  const std::int64_t now = seen.place.time_us;
  if (seen.frame.dest != context_.sink_am) {
    context_.report("J1-DEST"_rule, Severity::kFail, seen.place, mote,
                    {"A join_request goes to AM address " + number(seen.frame.dest) + ".",
                     "AM address " + number(context_.sink_am) + ", the sink's.",
                     {}});
  } else {
    context_.findings.kept("J1-DEST"_rule);
  }
  link_told(mote, now);
  next_.clear();
  if (!seen.place.timed()) {  // Any number of periods may lie between two frames.
    MoteHypothesis asked;
    asked.join.phase = Phase::kJoining;
    asked.join.requests = 1;
    asked.join.seq_num = request.seq_num;
    asked.join.descriptor = request.descriptor;
    next_.push_back(asked);
  }
  for (const MoteHypothesis& h : watch.set) {
    next_request(mote, h, now, request, next_);
  }
  if (next_.empty()) {
    refuse_request(mote, seen, request, as_member);
    return;
  }
  context_.findings.kept("J8-PERIOD"_rule);
  context_.findings.kept("J8-LIMIT"_rule);
  context_.findings.kept("J5-STOP"_rule);
  keep(watch, next_, mote, seen);
}

void MoteJoins::refuse_request(std::uint16_t mote, const Observation& seen, const Request& request,
                               bool as_member) {
  MoteWatch& watch = motes_[mote];
  const std::int64_t now = seen.place.time_us;
  // The furthest hypothesis is the latest state that the mote can have been in.
  const MoteHypothesis& h = watch.set.back();
  const bool same = request.seq_num == h.join.seq_num;
  Said said;
  ReqId rule = "J8-PERIOD"_rule;
  // Another number may come from a call after a reboot that was not captured. A whole log shows
  // reboots.
  const bool sure = same || context_.device(mote).whole;
  Severity severity = sure ? Severity::kFail : Severity::kInconclusive;
  const std::int64_t period = context_.join_period_us(mote);
  // A timer that runs on keeps its beat. Of calls a log of the application tells.
  const std::int64_t beat =
      (h.last_request_us - h.first_request_us) / std::max(1, h.join.requests - 1);
  const bool again =
      same && h.join.phase == Phase::kJoining && !context_.device(mote).application &&
      now - h.last_request_us > std::max(period, 2 * beat) + context_.response_us(mote);
  if (h.join.phase == Phase::kMember) {
    rule = as_member ? "J8-JOINED"_rule : "J5-STOP"_rule;
    // A link ack on the air alone may not have come (decision 102).
    if (!h.sent && !h.told && !h.linked) severity = Severity::kInconclusive;
    said.text = "A join_request with number " + number(request.seq_num) +
                " although the mote has joined " + text_of(h.join.address) + ".";
    said.expected = "No join_request of a mote that is joined.";
  } else if (now - h.last_request_us < period - context_.early_us(mote)) {
    said.text = "A join_request " + ms_text(now - h.last_request_us) + " after the one before it.";
    said.expected = "At least " + ms_text(period) + " between them (" +
                    ms_text(context_.early_us(mote)) + " less is tolerated).";
  } else if (again) {
    rule = "J1-SEQ"_rule;
    severity = Severity::kWeak;
    said.text = "A join_request with the number of the " + number(h.join.requests) +
                " before it, " + ms_text(now - h.last_request_us) +
                " after the last of these: no timer of that call still runs.";
    said.expected = "A new number for a new joinIsland call.";
  } else {
    rule = "J8-LIMIT"_rule;
    if (h.renumbered) severity = Severity::kInconclusive;
    said.text = "The " + number(h.join.requests + 1U) + "th join_request of one call (number " +
                number(request.seq_num) + ").";
    said.expected = "At most " + number(context_.profile(mote).join_requests_max) + ", then FAIL.";
  }
  said.hypotheses = explanations(mote, watch.set, said.text);
  context_.report(rule, severity, seen.place, mote, std::move(said));
  if (rule == "J5-STOP"_rule && !h.sent && !h.told && !h.linked) {
    MoteHypothesis unheard = h;
    unheard.confirmed = false;
    if (next_request(mote, unheard, now, request, next_)) return keep(watch, next_, mote, seen);
  }
  if (rule == "J5-STOP"_rule && !same) {
    watch.asked = MemberAsked{h.join.address, request.seq_num, now};
  }
  // Go on from what was seen: the call runs, and this was its latest request.
  MoteHypothesis next = h;
  if (h.join.phase == Phase::kMember && (same || as_member)) {
    next.last_request_us = now;
    watch.set.assign(1, next);
    return;
  }
  next.join.phase = Phase::kJoining;
  next.join.seq_num = request.seq_num;
  next.join.descriptor = request.descriptor;
  if (!same || again) next.join.requests = 0;
  ++next.join.requests;
  next.last_request_us = now;
  if (!same || again) next.first_request_us = now;
  watch.set.assign(1, next);
}

void MoteJoins::reply(std::uint16_t mote, const Observation& seen, std::uint32_t index,
                      const Reply& reply, bool surely_received) {
  MoteWatch& watch = motes_[mote];
  const Device& device = context_.device(mote);
  const std::int64_t now = seen.place.time_us;
  next_.clear();
  bool asked_for = false;
  for (const MoteHypothesis& h : watch.set) {
    MoteHypothesis heard = h;
    context_.actions.clear();
    const machine::Address offered{reply.island, reply.mote};
    if (h.unknown) {
      next_.push_back(h);  // It may have asked before the capture began, or not.
      continue;
    }
    // As long as an answer may take it may choose among offers.
    const bool chooses = h.join.phase == Phase::kMember && h.acks_seen == 0 && !h.told && !h.sent &&
                         h.join.address.pid != reply.island &&
                         now - h.accepted_us <= context_.response_us(mote);
    if (chooses) heard.join.phase = Phase::kJoining;
    const JoinSend send =
        machine::hear_reply(heard.join, context_.join_context(mote, 0, now), offered, reply.seq_num,
                            seen.frame.src, context_.actions);
    if (send != JoinSend::kAck) {
      next_.push_back(h);
      asked_for = asked_for || h.join.seq_num == reply.seq_num;
      continue;
    }
    asked_for = true;
    if (!chooses) heard.accepted_us = now;
    heard.reply = index;
    heard.acks_seen = 0;
    heard.void_offer = is_void(reply, device.am);
    if (!surely_received || chooses) next_.push_back(h);
    next_.push_back(heard);
  }
  if (!asked_for) {
    watch.wrong_reply = reply;
    watch.wrong_place = seen.place;
  }
  keep(watch, next_, mote, seen);
}

// Merges hypotheses that differ only in age; the youngest is the most permissive.
void MoteJoins::keep(MoteWatch& watch, std::vector<MoteHypothesis>& next, std::uint16_t mote,
                     const Observation& seen) {
  watch.set.clear();
  for (const MoteHypothesis& h : next) {
    const auto same = std::find_if(watch.set.begin(), watch.set.end(), [&](const auto& other) {
      return other.unknown == h.unknown && other.join.phase == h.join.phase &&
             other.join.seq_num == h.join.seq_num && other.join.requests == h.join.requests &&
             other.join.address == h.join.address && other.join.sink_devid == h.join.sink_devid &&
             other.acks_seen == h.acks_seen && other.first_request_us == h.first_request_us &&
             other.confirmed == h.confirmed && other.sent == h.sent &&
             other.void_offer == h.void_offer;
    });
    if (same == watch.set.end()) {
      watch.set.push_back(h);
    } else if (same->accepted_us < h.accepted_us) {
      *same = h;
    }
  }
  if (watch.set.size() <= kSetMax) return;
  context_.report("J4-ACK"_rule, Severity::kInconclusive, seen.place, mote,
                  {"More than " + number(kSetMax) + " explanations of this mote's join.",
                   "Fewer; it is not judged until it joins again.",
                   {}});
  MoteHypothesis unknown;
  unknown.unknown = true;
  watch.set.assign(1, unknown);
}

// Returns the rule that forbids this ack_join to the hypothesis; kNone if it is allowed.
ReqId MoteJoins::why_not_ack(std::uint16_t mote, const MoteHypothesis& h, const Observation& seen,
                             const AckJoin& ack) const {
  if (h.unknown) return ReqId::kNone;
  if (h.join.phase != Phase::kMember) return "J4-JOINED"_rule;
  AckJoin want = expected_ack(h);
  // If the call began before the capture only a part of it is known.
  const bool before = h.join.seq_num == 0 && h.join.descriptor == machine::Descriptor{};
  if (before) want.seq_num = ack.seq_num, want.descriptor = ack.descriptor;
  if (before || h.join.sink_devid == 0) want.dest = ack.dest;
  if (ack != want) {
    return ack.dest.pid != want.dest.pid && ack.seq_num == want.seq_num ? "J7-CHOICE"_rule
                                                                        : "J4-CONTENT"_rule;
  }
  if (seen.frame.dest != context_.sink_am) return "J4-CONTENT"_rule;
  if (h.acks_seen == 0 || !seen.place.timed()) return ReqId::kNone;
  const std::int64_t last = std::max(h.last_request_us, h.accepted_us + context_.response_us(mote));
  const std::int64_t whole_us = last + kAirMaxUs;  // The mote counts from the end of the frame.
  if (seen.place.time_us > whole_us + context_.join_period_us(mote) + context_.early_us(mote)) {
    return "J4-REPEAT"_rule;
  }
  return h.acks_seen > kAckJoinsMax ? "J4-REPEAT"_rule : ReqId::kNone;
}

void MoteJoins::ack_join(std::uint16_t mote, const Observation& seen, const AckJoin& ack,
                         bool confirmed) {
  MoteWatch& watch = motes_[mote];
  next_.clear();
  watch.asked.reset();
  for (const MoteHypothesis& h : watch.set) {
    MoteHypothesis next = h;
    // Of such an offer it may have taken the island alone.
    if (h.void_offer && ack.src.devid == seen.frame.src) next.join.address.devid = ack.src.devid;
    if (why_not_ack(mote, next, seen, ack) != ReqId::kNone) continue;
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
  if (next_.empty()) return refuse_ack(mote, seen, ack);
  judge_offer(mote, seen.place, next_);
  const std::uint8_t count = next_[0].acks_seen;
  context_.findings.kept(count > 1 ? "J4-REPEAT"_rule : "J4-CONTENT"_rule);
  context_.findings.kept("J4-SEQ"_rule);
  context_.findings.kept("J7-CHOICE"_rule);
  const std::uint8_t stated = context_.profile(mote).ack_join_max;
  const std::uint8_t few = stated == machine::Profile{}.ack_join_max ? kFewAcks : stated;
  if (count == few + 1) {
    context_.report("J4-FEW"_rule, Severity::kWeak, seen.place, mote,
                    {"The " + number(count) + "th ack_join of one join.",
                     "At most " + number(few - 1) + " repeats.",
                     {}});
  }
  watch.wrong_reply.reset();
  keep(watch, next_, mote, seen);
}

void MoteJoins::judge_offer(std::uint16_t mote, const Place& at, std::vector<MoteHypothesis>& set) {
  if (set.empty() || !std::ranges::all_of(set, &MoteHypothesis::void_offer)) return;
  Reply offer;
  parse_reply(context_.run.seen[set.back().reply].frame.payload, offer);
  context_.report("J4-ADDRESS"_rule, Severity::kWeak, at, mote,
                  {"The mote accepts the join_reply to its request " + number(offer.seq_num) +
                       ", which offers " + text_of({offer.island, offer.mote}) + ".",
                   "It ignores an offer to another TinyOS id, or of a reserved island.",
                   {}});
  for (MoteHypothesis& h : set) h.void_offer = false;
}

void MoteJoins::refuse_ack(std::uint16_t mote, const Observation& seen, const AckJoin& ack) {
  MoteWatch& watch = motes_[mote];
  const std::int64_t now = seen.place.time_us;
  const MoteHypothesis& h = watch.set.back();
  ReqId rule = why_not_ack(mote, h, seen, ack);
  Said said;
  said.hypotheses = explanations(mote, watch.set, "ack_join with " + ack_text(ack) + ".");
  Severity severity = Severity::kFail;
  if (rule == "J4-REPEAT"_rule) {
    said.text = "The same ack_join again, " + ms_text(now - h.accepted_us) + " after the reply.";
    said.expected = "Repeats within one join period (" + ms_text(context_.join_period_us(mote)) +
                    "), at most 20.";
    severity = context_.without(mote, h.acked_us, now);  // It may have asked again in between.
  } else if (h.join.phase == Phase::kMember) {
    said.text =
        "ack_join has " + ack_text(ack) + ", to AM address " + number(seen.frame.dest) + ".";
    said.expected = ack_text(expected_ack(h)) + ", to AM address " + number(context_.sink_am) + ".";
    // Another sink's offer, or a request with another number, may have escaped.
    if (rule == "J7-CHOICE"_rule && h.acks_seen == 0) {
      severity = context_.without(sink_of(ack.dest.pid), h.first_request_us, now);
      Place asked;
      asked.time_us = h.last_request_us;
      if (severity == Severity::kFail && may_take_copy(mote, h, ack, now)) {
        severity = context_.without_copy(mote, asked, now);
      }
    } else if (ack.seq_num != h.join.seq_num) {
      const bool asked_so = std::any_of(watch.set.begin(), watch.set.end(), [&](const auto& other) {
        return other.join.phase == Phase::kJoining && other.join.seq_num == ack.seq_num;
      });
      const bool elsewhere = ack.dest.pid != h.join.address.pid;  // A mote with the same id there.
      severity = context_.without(asked_so || elsewhere ? kNobody : mote, h.last_request_us, now);
    }
  } else {
    // It acks a reply that it should not have accepted; the last replies may show which.
    const std::int64_t recent_us = context_.response_us(mote) + context_.join_period_us(mote);
    const bool recent = watch.wrong_reply && now - watch.wrong_place.time_us <= recent_us;
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
    // An ack_join that fits its own request may answer a reply that was not captured.
    if (asked && ack.seq_num != h.join.seq_num) {  // Its own, asked anew.
      severity = context_.without(mote, h.last_request_us, now);
      if (context_.lossy_air) severity = Severity::kInconclusive;  // A namesake's, elsewhere.
    }
    const std::int64_t since_us = h.first_request_us - context_.response_us(mote);
    if (own) severity = context_.without(kNobody, since_us, now);  // Its copy may be damaged.
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

// Reports that a member asked for a join, if it goes on as that member: had it started anew, it
// would have joined before it sent. Returns whether it did.
bool MoteJoins::asked_as_member(std::uint16_t mote, const Place& at, machine::Address src,
                                bool only) {
  const std::optional<MemberAsked> asked = std::exchange(motes_[mote].asked, std::nullopt);
  if (!asked || asked->address != src) return false;
  const Severity severity = context_.without(mote, asked->time_us, at.time_us);
  context_.report(
      "J5-STOP"_rule, only ? severity : std::min(severity, Severity::kInconclusive), at, mote,
      {"A net_msg with src " + text_of(src) + ", as before the join_request with number " +
           number(asked->seq_num) + ", sent " + ms_text(at.time_us - asked->time_us) +
           " ago, and without another ack_join: it had joined when it asked.",
       "No join_request of a mote that is joined.",
       {}});
  return true;
}

void MoteJoins::net_msg(std::uint16_t mote, const Observation& seen, const Net& net) {
  MoteWatch& watch = motes_[mote];
  std::vector<MoteHypothesis>& set = watch.set;
  const std::int64_t now = seen.place.time_us;
  if (set.size() == 1 && set[0].join.phase == Phase::kMember && set[0].sent &&
      set[0].join.address == net.src) {
    set[0].sent_us = now;
    context_.findings.kept("J11-SEND"_rule);
    context_.findings.kept("N1-SRC"_rule);
    return;
  }
  const auto member_known = [&](const MoteHypothesis& h) {
    return !h.unknown && h.join.phase == Phase::kMember;
  };
  const std::uint16_t am = context_.device(mote).am;
  if (net.src.devid != am && std::ranges::none_of(set, member_known)) {
    context_.report("N1-SRC"_rule, context_.without_ever(mote, now), seen.place, mote,
                    {"A net_msg with src " + text_of(net.src) + " from AM address " + number(am) +
                         ": no join gives a mote another devid (J4-ADDRESS).",
                     "src " + text_of(machine::Address{net.src.pid, am}) + ".",
                     {}});
    return;
  }
  // Of two motes with one id in two islands it may be the other.
  const bool only = context_.next_of_am[context_.mote_of_am[context_.device(mote).am]] == kNobody;
  std::vector<MoteHypothesis> before = set;
  const auto fits = [&](const MoteHypothesis& h) {
    return h.unknown || (h.join.phase == Phase::kMember && h.join.address == net.src);
  };
  // Again under an address that it surely does not have: it has the other.
  if (std::ranges::any_of(set, [&](const auto& h) { return h.wrong && fits(h); })) return;
  std::erase_if(set, [&](const MoteHypothesis& h) { return !fits(h); });
  // A member may send before its ack_join has left (decision 118).
  const auto acks = [&](const Observation& later) {
    return later.kind == Observation::Kind::kRadio && !later.received &&
           later.frame.type == am::kAckJoin && later.frame.src == am;
  };
  const bool ack_follows = context_.next(now, context_.response_us(mote), acks) != nullptr;
  const bool blamed = !ack_follows && asked_as_member(mote, seen.place, net.src, only);
  for (MoteHypothesis& h : set) {
    const bool was_unknown = h.unknown;
    if (!was_unknown && h.acks_seen == 0 && !ack_follows && !blamed &&
        context_.without(mote, h.accepted_us, now) == Severity::kFail) {
      context_.report("J4-ACK"_rule, only ? Severity::kFail : Severity::kInconclusive, seen.place,
                      mote,
                      {"A net_msg from " + text_of(net.src) + " before any ack_join.",
                       "ack_join, within the response time.",
                       {}});
    }
    h.unknown = false;
    h.join.phase = Phase::kMember;
    h.join.address = net.src;
    if (!ack_follows) h.acks_seen = std::max<std::uint8_t>(h.acks_seen, 1);
    h.sent = true;
    h.sent_us = now;
    if (!was_unknown) continue;
    h.join.seq_num = 0;
    h.accepted_us = now;  // At the latest.
  }
  if (!set.empty()) {
    set.resize(1);
    return;
  }
  Said said;
  said.hypotheses = explanations(mote, before, "A net_msg from " + text_of(net.src) + " came.");
  const MoteHypothesis h_before = before.back();
  const MoteHypothesis& h = h_before;
  const bool member = h.join.phase == Phase::kMember;
  if (member) {
    said.text = "A net_msg with src " + text_of(net.src) + " from a mote whose address is " +
                text_of(h.join.address) + ".";
    said.expected = "src " + text_of(h.join.address) + ".";
  } else {
    said.text = "A net_msg from " + text_of(net.src) + " before the mote has joined.";
    said.expected = "No net_msg before ack_join.";
  }
  // A member may have another address by a join since it last showed this one.
  const bool ever = h.join.phase == Phase::kOutside && h.first_request_us == 0;
  const std::int64_t since = member ? std::max(h.accepted_us, h.sent_us)
                             : ever ? watch.booted_us
                                    : context_.device(mote).first_us;
  Severity severity = ever && watch.booted_us < 0 ? context_.without_ever(mote, now)
                                                  : context_.without(mote, since, now);
  if (!only) severity = std::min(severity, Severity::kInconclusive);
  if (!blamed) {
    context_.report(member ? "N1-SRC"_rule : "J11-SEND"_rule, severity, seen.place, mote,
                    std::move(said));
  }
  MoteHypothesis next;
  next.join.phase = Phase::kMember;
  next.join.address = net.src;
  next.acks_seen = 1;
  next.sent = true;
  next.accepted_us = next.sent_us = now;
  next.wrong = member && severity == Severity::kFail;
  set.assign(1, next);
  if (member) set.push_back(h_before);  // Perhaps only this message was wrong.
}

std::optional<machine::Address> MoteJoins::address(std::uint16_t mote) const {
  const auto& set = motes_[mote].set;
  if (set.size() != 1 || set[0].unknown || set[0].join.phase != Phase::kMember) return {};
  return set[0].join.address;
}

bool MoteJoins::is_outside(std::uint16_t mote) const {
  const auto& set = motes_[mote].set;
  return !set.empty() && std::all_of(set.begin(), set.end(), [](const MoteHypothesis& h) {
    return !h.unknown && h.join.phase != Phase::kMember;
  });
}

bool MoteJoins::surely_member(std::uint16_t mote) const {
  const auto& set = motes_[mote].set;
  return address(mote) && (set[0].told || set[0].sent);
}

std::vector<Hypothesis> MoteJoins::explanations(std::uint16_t mote,
                                                const std::vector<MoteHypothesis>& set,
                                                const std::string& miss) const {
  std::vector<Hypothesis> out;
  for (auto it = set.rbegin(); it != set.rend(); ++it) {
    out.push_back({sentence(*it), allows(mote, *it), miss});
  }
  return out;
}

std::string MoteJoins::sentence(const MoteHypothesis& h) const {
  if (h.unknown) return "It ran before the capture began.";
  switch (h.join.phase) {
    case Phase::kOutside: return "It has not joined and asks nobody.";
    case Phase::kJoining:
      return "It waits for the answer to request " + number(h.join.seq_num) + ", sent " +
             number(h.join.requests) + (h.join.requests == 1 ? " time." : " times.");
    case Phase::kMember:
      return "It has accepted the reply to " + number(h.join.seq_num) + " and is " +
             text_of(h.join.address) + ".";
  }
  return {};
}

std::string MoteJoins::allows(std::uint16_t mote, const MoteHypothesis& h) const {
  if (h.unknown) return "Anything that a mote may send.";
  switch (h.join.phase) {
    case Phase::kOutside: return "A join_request.";
    case Phase::kJoining:
      return h.join.requests < context_.profile(mote).join_requests_max
                 ? "A join_request, " + ms_text(context_.join_period_us(mote)) + " after the last."
                 : "Nothing but FAIL to its application.";
    case Phase::kMember:
      return "ack_join to <" + number(h.join.address.pid) + ", " + number(h.join.sink_devid) +
             "> from " + text_of(h.join.address) + " with number " + number(h.join.seq_num) +
             ", then messages from that address.";
  }
  return {};
}

}  // namespace rubric::check
