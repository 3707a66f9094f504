#include "conformance/check/judge/join_watch.h"

#include <algorithm>

#include "conformance/check/links.h"

namespace rubric::check {
namespace {

using Phase = machine::JoinMote::Phase;

constexpr std::size_t kJoinCrowd = 6;       // Frames; then a buffer may have been full.
constexpr std::int64_t kClockOffMs = 1000;  // No parameter says it (decision 119).

}  // namespace

JoinWatch::JoinWatch(Context& context, MoteJoins& motes, SinkJoins& sinks, std::size_t devices)
    : context_(context), motes_(motes), sinks_(sinks), debts_(devices), off_(devices, false) {}

void JoinWatch::rebooted(std::uint16_t node, std::int64_t now_us) {
  settle(node, now_us, false);
  debts_[node].clear();
  off_[node] = false;
}

void JoinWatch::radio_set(std::uint16_t node, bool on, std::int64_t now_us) {
  settle(node, now_us, false);
  // By a whole log a request is sent again if the radio is on again in time.
  const bool whole = context_.device(node).whole;
  if (!on) {
    std::erase_if(debts_[node],
                  [&](const Debt& debt) { return debt.owes != Owes::kRetry || !whole; });
  }
  std::erase_if(debts_[node], [&](Debt& debt) {
    const std::int64_t expiry_us =
        context_.run.seen[debt.index].place.time_us + context_.join_period_us(node);
    debt.due_us = on ? context_.due_us(node, expiry_us, machine::Link::kRadio) : INT64_MAX;
    return on && expiry_us < now_us;  // Its timer expired while it was off.
  });
  off_[node] = !on;
}

// A busy line or application stops the time (decision 125).
bool JoinWatch::waits(std::uint16_t node) const { return context_.run.has_time && !off_[node]; }

void JoinWatch::owe(std::uint16_t node, const Debt& debt) {
  if (debts_[node].size() < kRoom) debts_[node].push_back(debt);
}

void JoinWatch::asked(std::uint16_t mote, std::uint32_t index) {
  std::vector<Debt>& debts = debts_[mote];
  std::erase_if(debts, [](const Debt& debt) { return debt.owes == Owes::kRetry; });
  // In a capture a mote that gave up looks like one that was switched off (decision 101).
  const Device& device = context_.device(mote);
  if (!device.hearing || !device.application || !waits(mote)) return;
  Debt debt;
  debt.owes = Owes::kRetry;
  debt.index = index;
  debt.due_us =
      context_.due_us(mote, context_.run.seen[index].place.time_us + context_.join_period_us(mote),
                      machine::Link::kRadio);
  owe(mote, debt);
}

void JoinWatch::repeats(std::uint16_t mote, std::int64_t now_us) {
  if (!context_.device(mote).whole) return;
  std::erase_if(debts_[mote], [&](const Debt& debt) {
    if (debt.owes != Owes::kRetry || now_us <= debt.due_us || !still_owed(mote, debt)) return false;
    const std::int64_t from = context_.run.seen[debt.index].place.time_us;
    const bool open = crowded(mote, debt) ||
                      context_.busy(mote, from, debt.due_us, machine::Link::kRadio) ||
                      context_.who.damaged(from, now_us);
    missing(mote, debt, open ? Severity::kInconclusive : Severity::kFail);
    return true;
  });
}

void JoinWatch::asks_again(std::uint16_t mote, std::uint16_t seq_num, std::int64_t now_us) {
  const auto same = [seq_num](const Debt& debt) {
    return debt.owes == Owes::kAck && debt.seq_num == seq_num;
  };
  const bool log = context_.device(mote).hearing;
  if (!log && std::ranges::any_of(debts_[mote], same)) settle(mote, now_us, false);
}

// Returns how long the mote that asked waits for a reply: its timer runs, not the sink's.
std::int64_t JoinWatch::waits_us(const Debt& debt) const {
  return context_.join_call_us(context_.slowest_mote(debt.mote_am));
}

// A late answer is lawful (decision 125): it is missing once the mote's call is over, here the
// longest of them all.
void JoinWatch::hears_on(std::uint16_t sink, std::int64_t now_us) {
  if (context_.device(sink).hearing) return;
  std::int64_t longest_us = 0;
  for (const Debt& debt : debts_[sink]) longest_us = std::max(longest_us, waits_us(debt));
  settle(sink, now_us - longest_us, false);
}

void JoinWatch::surely_asked(std::uint16_t sink, std::uint32_t index, std::uint16_t seq_num) {
  const Observation& seen = context_.run.seen[index];
  const std::uint16_t am = seen.frame.src;
  if (sink == kNobody || !waits(sink) || am == context_.sink_am || machine::is_reserved(am)) return;
  Debt debt;
  debt.mote_am = am;
  debt.seq_num = seq_num;
  debt.index = index;
  debt.due_us = context_.due_us(sink, seen.place.time_us + air_us(seen), machine::Link::kRadio);
  if (!still_owed(sink, debt)) return;
  owe(sink, debt);
  sinks_.settled(am);
}

void JoinWatch::answered(std::uint16_t sink, std::uint16_t mote_am, const Place& at) {
  std::int64_t asked_us = -1;
  std::vector<Debt>& debts = debts_[sink];
  const auto answers = [&](const Debt& debt) {
    return debt.mote_am == mote_am && !still_owed(sink, debt);
  };
  for (const Debt& debt : debts) {
    if (answers(debt)) asked_us = context_.run.seen[debt.index].place.time_us;
  }
  std::erase_if(debts, answers);
  for (Debt& debt : debts) {
    debt.overtaken = debt.overtaken || context_.run.seen[debt.index].place.time_us < asked_us;
  }
  if (asked_us >= 0) {
    context_.left(sink, machine::Link::kRadio, at, asked_us,
                  context_.handled_us(sink, asked_us, at.time_us),
                  "the join_reply to mote " + number(mote_am));
  }
  settle(sink, at.time_us, false);
}

void JoinWatch::surely_offered(std::uint16_t mote, std::uint32_t index, const Reply& reply) {
  if (!waits(mote)) return;
  Debt debt;
  debt.owes = Owes::kAck;
  debt.seq_num = reply.seq_num;
  debt.index = index;
  const Observation& seen = context_.run.seen[index];
  debt.due_us = context_.due_us(mote, seen.place.time_us + air_us(seen), machine::Link::kRadio);
  owe(mote, debt);
}

// Returns whether every explanation of the node owes it.
bool JoinWatch::still_owed(std::uint16_t node, const Debt& debt) {
  const Observation& cause = context_.run.seen[debt.index];
  const std::int64_t from = cause.place.time_us;
  // Where no event ends a call, it may be over after as few as end in FAIL elsewhere.
  const machine::Profile& profile = context_.profile(node);
  const std::uint8_t requests_min = context_.device(node).whole && profile.join_fail_signalled
                                        ? profile.join_requests_max
                                        : motes_.expiries_min(node);
  if (debt.owes != Owes::kReply) {
    const auto owes = [&](const MoteHypothesis& h) {
      if (h.unknown) return false;
      if (debt.owes == Owes::kAck) {
        return h.join.phase == Phase::kMember && h.acks_seen == 0 && h.accepted_us == from &&
               h.join.seq_num == debt.seq_num;
      }
      // Requests that had to wait since the call may have been used up.
      const std::int64_t waited =
          (h.first_request_us - motes_.began_us(node, h)) / context_.join_period_us(node);
      return h.join.phase == Phase::kJoining && h.last_request_us == from &&
             h.join.requests + waited < requests_min;
    };
    const std::vector<MoteHypothesis>& set = motes_.set(node);
    return !set.empty() && std::all_of(set.begin(), set.end(), owes);
  }
  SinkWatch* const sink = sinks_.find(node);
  if (sink == nullptr) return false;
  const auto pair = sink->motes.find(debt.mote_am);
  if (pair == sink->motes.end()) return false;
  const auto owes = [&](const SinkHypothesis& h) {
    const auto end = h.owed_seq.begin() + h.owed;
    return !h.unknown && std::find(h.owed_seq.begin(), end, debt.seq_num) != end;
  };
  const std::vector<SinkHypothesis>& set = pair->second.set;
  if (pair->second.cut_off) return std::ranges::any_of(set, owes);
  return !set.empty() && std::all_of(set.begin(), set.end(), owes);
}

// Returns whether a sink owes it to a mote that it should have forgotten with its former island.
bool JoinWatch::forgets(std::uint16_t node, const Debt& debt) {
  SinkWatch* const sink = debt.owes == Owes::kReply ? sinks_.find(node) : nullptr;
  const auto pair =
      sink == nullptr ? decltype(sink->motes.end()){} : sink->motes.find(debt.mote_am);
  return sink != nullptr && pair != sink->motes.end() && pair->second.cut_off;
}

void JoinWatch::settle(std::uint16_t node, std::int64_t now_us, bool end) {
  std::vector<Debt>& debts = debts_[node];
  if (debts.empty()) return;
  const Device& device = context_.device(node);
  std::erase_if(debts, [&](const Debt& debt) {
    // A later event of the application may still show whether it is owed. By a log that is not
    // whole a late reply is lawful (decision 125): it is missing once the mote's call is over, or
    // when a later one was sent.
    const bool patient = debt.owes == Owes::kReply && device.hearing && !device.whole && !end;
    const std::int64_t waits_us = patient && !debt.overtaken ? this->waits_us(debt) : 0;
    if (now_us <= debt.due_us + waits_us && (!end || device.hearing)) return false;
    if (!still_owed(node, debt)) return true;
    const std::int64_t from = context_.run.seen[debt.index].place.time_us;
    // At its end a log of what the node was given needs no sign of life; a capture does.
    const bool sure =
        !context_.who.damaged(from, now_us) &&
        (device.hearing || (!end && context_.without(node, from, now_us) == Severity::kFail));
    // What waited for a line that was busy may have filled a buffer.
    const bool open =
        crowded(node, debt) || context_.busy(node, from, debt.due_us, machine::Link::kRadio);
    missing(node, debt, sure && !open ? Severity::kFail : Severity::kInconclusive);
    return true;
  });
}

// Returns whether so many frames went through the node around that time that a buffer may have been
// full (decision 122).
bool JoinWatch::crowded(std::uint16_t node, const Debt& debt) const {
  if (context_.device(node).whole) {
    return context_.crowded(node, context_.run.seen[debt.index].place.time_us);
  }
  const std::vector<Observation>& seen = context_.run.seen;
  std::size_t frames = 0;
  for (std::size_t i = debt.index; i < seen.size() && frames <= kJoinCrowd; ++i) {
    if (seen[i].place.time_us > debt.due_us) break;
    const Mark& mark = context_.who.marks[i];
    if (mark.device == node || mark.receiver == node) ++frames;
  }
  return frames > kJoinCrowd;
}

void JoinWatch::missing(std::uint16_t node, const Debt& debt, Severity severity) {
  const Observation& cause = context_.run.seen[debt.index];
  const bool log = context_.device(node).hearing;
  const std::string proof = log ? "was given" : "received (the link acknowledged it)";
  const std::string within = "within " + ms_text(context_.response_us(node)) + ".";
  switch (debt.owes) {
    case Owes::kRetry:
      context_.report(
          "J8-RETRY"_rule, severity, cause.place, node,
          {"No join_request follows this one in time, no reply came that the mote could "
           "accept, and requests remain.",
           "The join_request again, " + ms_text(context_.join_period_us(node)) + " after the last.",
           {}});
      return;
    case Owes::kAck:
      context_.report("J4-ACK"_rule, severity, cause.place, node,
                      {"The mote " + proof + " the join_reply to its request " +
                           number(debt.seq_num) + " and sends no ack_join.",
                       "ack_join " + within,
                       {}});
      return;
    case Owes::kReply:
      if (forgets(node, debt)) {
        context_.report("N9-MEMBERS"_rule, severity == Severity::kFail ? Severity::kWeak : severity,
                        cause.place, node,
                        {"The sink " + proof + " the join_request " + number(debt.seq_num) +
                             " of mote " + number(debt.mote_am) +
                             ", which it listed under its former island, and does not answer it.",
                         "It forgets its members with its island: a join_reply " + within,
                         {}});
        return;
      }
      context_.report(
          debt.overtaken ? "J9-INTERLEAVE"_rule : "J3-REPLY"_rule, severity, cause.place, node,
          {"The sink " + proof + " the join_request " + number(debt.seq_num) + " of mote " +
               number(debt.mote_am) + ", which it does not list, and does not answer it" +
               (debt.overtaken ? "; a later one of another mote it did." : "."),
           "A join_reply " + within,
           {}});
      return;
  }
}

//= J4-CLOCK: A mote that accepts a join_reply sets its clock to cur_time.
void JoinWatch::clock_told(std::uint16_t mote, const Observation& seen, std::uint32_t ms) {
  if (!context_.run.has_time) return;
  const std::vector<MoteHypothesis>& set = motes_.set(mote);
  Said said;
  for (const MoteHypothesis& h : set) {
    const machine::Frame& frame = context_.run.seen[h.reply].frame;
    Reply reply;
    // A clock before the join shows nothing; nor does one after a reply that nobody saw.
    if (stepped(context_.run.steps, h.accepted_us, seen.place.time_us)) return;
    if (h.unknown || h.join.phase != Phase::kMember || frame.type != am::kJoinReply ||
        !parse_reply(frame.payload, reply) || reply.seq_num != h.join.seq_num) {
      return;
    }
    const std::int64_t passed_ms = (seen.place.time_us - h.accepted_us) / 1000;
    const std::int64_t grown_ms = grown_ms_of(reply.time_ms, ms, passed_ms);
    // A clock in binary ms runs 2.4 % faster than one in ms.
    if (grown_ms >= passed_ms - kClockOffMs &&
        grown_ms <= passed_ms + passed_ms * 24 / 1000 + kClockOffMs) {
      context_.findings.kept("J4-CLOCK"_rule);
      return;
    }
    said.text = "The mote's clock says " + number(ms) + ", " +
                ms_text(seen.place.time_us - h.accepted_us) +
                " after it accepted a reply with cur_time " + number(reply.time_ms) + ".";
    said.expected = "cur_time and what has passed since, within 1 s.";
  }
  if (!set.empty()) {
    context_.report("J4-CLOCK"_rule, Severity::kFail, seen.place, mote, std::move(said));
  }
}

void JoinWatch::finish() {
  for (std::uint16_t i = 0; i < debts_.size(); ++i) settle(i, context_.end_us(i), true);
}

}  // namespace rubric::check
