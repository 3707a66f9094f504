// What shows that a sink began anew: its clock, as its join_replies tell it (decision 119), and the
// island that it acts for (decision 123); and what it forgets, or may answer unseen.
#include <algorithm>
#include <utility>

#include "conformance/check/judge/sink_join.h"
#include "conformance/check/links.h"

namespace rubric::check {

void SinkJoins::forgot(std::uint16_t sink, std::uint16_t mote_am) {
  SinkWatch* const watch = find(sink);
  if (watch == nullptr) return;
  PairWatch& mote = pair(*watch, mote_am);
  watch->set_due(mote, false);
  next_.clear();
  for (SinkHypothesis h : mote.set) {
    h.unknown = h.owes_report = h.owes_notice = false;
    h.member.reset();
    next_.push_back(h);
  }
  keep(*watch, mote, next_, mote.ack);
}

// Returns whether the reply may answer the link's copy of a request where only one of the two was
// captured, which leaves no gap in the DSNs. A copy counts once for all sinks that heard it.
bool SinkJoins::answers_copy(std::uint16_t sink, const PairWatch& watch, const Observation& seen,
                             const Reply& reply) {
  const std::int64_t now = seen.place.time_us;
  if (context_.device(sink).hearing || !seen.place.timed()) return false;
  const auto is_request = [&](const Observation& one) {
    Request request;
    return one.kind == Observation::Kind::kRadio && one.frame.src == seen.frame.dest &&
           one.frame.type == am::kJoin && parse_request(one.frame.payload, request) &&
           request.seq_num == reply.seq_num;
  };
  const Observation* const later = context_.next(now, kLinkRepeatUs, is_request);
  const bool before = watch.asked && watch.request_seq == reply.seq_num &&
                      now <= context_.due_us(sink, watch.request.time_us) + kLinkRepeatUs;
  if (!before && later == nullptr) return false;
  const Place& request = before ? watch.request : later->place;
  const bool counted = copied_.file == request.file && copied_.frame == request.frame;
  if (!counted && context_.copies_missed == 0) return false;
  if (!counted) --context_.copies_missed;
  copied_ = request;
  return true;
}

void SinkJoins::judge_clock(SinkWatch& sink, const Observation& seen, const Reply& reply) {
  constexpr std::int64_t kOffMs = 1000;  // No parameter says it (decision 119).
  const std::int64_t now = seen.place.time_us;
  const std::vector<ClockStep>& steps = context_.run.steps;
  const bool stepped = doubt_us(steps, sink.clock_us, now) == ClockStep::kUnknown;
  if (!sink.has_clock || stepped || reply.time_ms != sink.clock_ms) sink.still_us = now;
  if (sink.has_clock && seen.place.timed() && sink.clock_us >= 0 && !stepped) {
    std::int64_t from_us = sink.clock_us;
    std::int64_t passed_ms = (now - from_us) / 1000;
    const std::int64_t grown_ms = grown_ms_of(sink.clock_ms, reply.time_ms, passed_ms);
    // Replies that follow each other fast stand still together.
    if (grown_ms == 0 && passed_ms < kOffMs) {
      from_us = sink.still_us;
      passed_ms = (now - from_us) / 1000;
    }
    // Where a step of the recorder's clock was seen, shorter ones may hide.
    std::int64_t doubt_ms = doubt_us(steps, from_us, now) / 1000;
    if (doubt_ms > 0) doubt_ms += context_.run.slack_us / 1000;
    const std::int64_t least_ms = passed_ms - doubt_ms;
    // A clock in binary ms runs 2.4 % faster than one in ms.
    const std::int64_t most_ms = (passed_ms + doubt_ms) * 1024 / 1000 + kOffMs;
    // A reply may have waited for so long, for the channel as well.
    const std::int64_t waited_ms = context_.response_us(sink.device) / 1000;
    if (grown_ms < passed_ms - passed_ms / 20 - waited_ms) sink.behind_us = now;
    Said said;
    said.text = "cur_time went from " + number(sink.clock_ms) + " to " + number(reply.time_ms) +
                " while " + number(static_cast<std::uint64_t>(passed_ms)) + " ms passed.";
    said.expected = "Growth as time passes, within 1 s.";
    const bool off = grown_ms < least_ms - kOffMs || grown_ms > most_ms;
    const bool still = reply.time_ms == sink.clock_ms && least_ms >= kOffMs;
    if (still && (off || grown_ms == 0)) {
      // A step of the recorder's clock looks the same where frames that would show it are missing.
      context_.report("J3-TIME"_rule,
                      context_.lossy_air ? Severity::kInconclusive : Severity::kFail, seen.place,
                      sink.device, std::move(said));
    } else if (off) {
      // A reboot starts it anew, which a capture does not show. The new clock may by now say more
      // than the old one did.
      const bool anew =
          reply.time_ms <= passed_ms + doubt_ms + kOffMs && !context_.device(sink.device).hearing;
      said.beyond = !anew;  // What stands still is accepted, in each life.
      context_.report("J3-DRIFT"_rule, anew ? Severity::kInconclusive : Severity::kWeak, seen.place,
                      sink.device, std::move(said));
    } else {
      context_.findings.kept("J3-TIME"_rule);
    }
  }
  sink.has_clock = true;
  sink.clock_ms = reply.time_ms;
  sink.clock_us = now;
}

bool SinkJoins::keeps_former(SinkWatch& sink, std::uint16_t shown, const Place& at,
                             std::int64_t cause_us) {
  if (!may_be_told(sink)) return false;
  const bool damaged = std::exchange(sink.perhaps_told, false);
  const bool former = shown == sink.former_island;
  const bool under_way = cause_us >= 0 && cause_us < sink.island_set_us &&
                         at.time_us <= context_.due_us(sink.device, sink.island_set_us);
  if (former && under_way) return true;
  const Device& device = context_.device(sink.device);
  const bool behind = sink.behind_us > sink.island_set_us;
  // It took that island, and no frame on the air shows that it has gone on since.
  const bool unheard =
      cause_us < 0 && sink.island_shown_us > sink.island_set_us && device.last_us < at.time_us;
  const bool anew =
      behind || unheard || context_.may_have_restarted(sink.device, sink.island_set_us, at.time_us);
  const bool started = sink.start_island == kNoIsland || sink.start_island == shown;
  const bool rebooted = anew && started && !device.hearing;
  if (!rebooted && !damaged && (sink.island_sure || !former)) return false;
  const std::string why = damaged ? "a packet down its line, which came damaged, may have told it."
                          : !rebooted ? "nothing proves that it heard that."
                          : behind    ? "its clock began anew, so that it may have lost its power."
                          : unheard   ? "it may have lost its power since it was last heard."
                                      : "its DSNs began anew, so that it may have lost its power.";
  context_.report("N9-SET"_rule, Severity::kInconclusive, at, sink.device,
                  {"The sink acts for island " + number(shown) + " after it " +
                       (sink.island_set ? "was" : "had perhaps been") + " told island " +
                       number(sink.island) + "; " + why,
                   "Island " + number(sink.island) + ", if it was told.",
                   {}});
  if (damaged) {
    for (auto& [am, pair] : sink.motes) {
      sink.set_due(pair, false);
      pair.know_nothing();
    }
  }
  sink.island = shown;
  sink.former_island = kNoIsland;
  if (rebooted) sink.start_island = shown;  // It begins each life with one island.
  sink.island_sure = true;
  return true;
}

// Returns whether the sink was told its island, perhaps before the capture.
bool SinkJoins::may_be_told(const SinkWatch& sink) const {
  return sink.island_set || sink.perhaps_told || !context_.options.start_cold;
}

bool SinkJoins::is_former(std::uint16_t sink, machine::Address address, const Place& at) {
  SinkWatch* const watch = find(sink);
  const auto of_another = [&](const SinkWatch& other) {  // What it passes on for that one.
    return other.device != sink && other.island == address.pid;
  };
  return watch != nullptr && address.devid == context_.device(sink).am &&
         address.pid != watch->island && !machine::is_reserved(address.pid) &&
         std::ranges::none_of(sinks_, of_another) && keeps_former(*watch, address.pid, at, -1);
}

void SinkJoins::perhaps_told(std::uint16_t sink) {
  if (SinkWatch* const watch = find(sink)) watch->perhaps_told = true;
}

void SinkJoins::acts(std::uint16_t sink, std::int64_t now_us) {
  SinkWatch* const watch = find(sink);
  if (watch == nullptr) return;
  watch->island_shown_us = now_us;
  watch->perhaps_told = false;
}

bool SinkJoins::may_have_lost_island(std::uint16_t sink, std::int64_t now_us) const {
  const auto its = std::ranges::find(sinks_, sink, &SinkWatch::device);
  return its != sinks_.end() && may_be_told(*its) &&
         context_.may_have_restarted(sink, std::max(its->island_set_us, its->island_shown_us),
                                     now_us);
}

}  // namespace rubric::check
