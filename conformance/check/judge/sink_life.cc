// The clock of a sink, as its join_replies tell it (decision 119).
#include "conformance/check/judge/sink_join.h"

namespace rubric::check {

void SinkJoins::judge_clock(SinkWatch& sink, const Observation& seen, const Reply& reply) {
  constexpr std::int64_t kOffMs = 1000;
  constexpr std::int64_t kBehindMs = 300;  // Of a reply that waited for the channel.
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
    if (grown_ms < passed_ms - passed_ms / 20 - kBehindMs) sink.behind_us = now;
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

}  // namespace rubric::check
