// judge(), as observation.h declares it. It judges a run in more than one way where only common
// frames tell the order of its files, where the clock of a recorder stepped, or where those of its
// taps differ.
#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/check/align/align_logs.h"
#include "conformance/check/input/read.h"
#include "conformance/check/judge/context.h"
#include "conformance/check/judge/findings.h"
#include "conformance/check/judge/judge_pass.h"
#include "conformance/check/links.h"
#include "conformance/check/message.h"
#include "conformance/check/observation.h"

namespace rubric::check {
namespace {

bool blames(const Finding& finding) {
  return finding.severity == Severity::kFail || finding.severity == Severity::kWeak;
}

// Identifies a finding; its text may have other times.
using Name = std::tuple<std::size_t, std::string, std::uint32_t, std::uint64_t>;
Name name_of(const Finding& finding) {
  return {reflect::requirement_index(finding.requirement), finding.node, finding.place.file,
          finding.place.frame};
}

std::set<Name> blamed_in(const Report& report) {
  std::set<Name> out;
  for (const Finding& finding : report.findings) {
    if (blames(finding)) out.insert(name_of(finding));
  }
  return out;
}

const LoosePlace* place_of(const Run& run, const Place& place) {
  const auto at = std::lower_bound(
      run.loose.begin(), run.loose.end(), place, [](const LoosePlace& one, const Place& other) {
        return std::tie(one.file, one.frame) < std::tie(other.file, other.frame);
      });
  const bool found = at != run.loose.end() && at->file == place.file && at->frame == place.frame;
  return found ? &*at : nullptr;
}

// Returns the span in which all loose files were surely recorded.
std::pair<std::int64_t, std::int64_t> between_of(const Run& run) {
  constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  std::map<std::uint32_t, std::pair<std::int64_t, std::int64_t>> of_file;
  for (const LoosePlace& place : run.loose) {
    if (!place.between) continue;
    const auto file = of_file.emplace(place.file, std::pair(place.late_us, place.early_us)).first;
    file->second.first = std::min(file->second.first, place.late_us);
    file->second.second = std::max(file->second.second, place.early_us);
  }
  std::pair<std::int64_t, std::int64_t> out{0, kNone};
  for (const auto& [file, times] : of_file) {
    out.first = std::max(out.first, times.first);
    out.second = std::min(out.second, times.second);
  }
  return out;
}

// Loose frames are at their likely, earliest or latest times, or left out; lines with slack are
// where they are, later by half of the slack, or by all of it.
enum class When : std::uint8_t { kLikely, kEarly, kLate, kNever };

Report judge_with(const Run& run, const Options& options, When when) {
  Run now = run;
  now.loose.clear();
  now.slack_taps.clear();
  const std::int64_t later_us = when == When::kEarly  ? run.slack_us / 2
                                : when == When::kLate ? run.slack_us
                                                      : 0;
  for (Observation& seen : now.seen) {
    const bool line = !run.slack_taps.empty() && seen.node.empty() && run.slack_taps[seen.tap];
    if (line && seen.place.timed()) seen.place.time_us += later_us;
  }
  if (when == When::kNever) {
    std::erase_if(now.seen, [](const Observation& seen) { return seen.place.loose; });
  } else if (when != When::kLikely) {
    for (Observation& seen : now.seen) {
      const LoosePlace* const place = seen.place.loose ? place_of(run, seen.place) : nullptr;
      if (place == nullptr) continue;
      seen.place.time_us = when == When::kEarly ? place->early_us : place->late_us;
    }
  }
  merge(now);
  now.has_time = run.has_time;
  now.start_us = run.start_us;  // For a part of a run its maker sets these.
  now.end_us = run.end_us;
  return judge(now, options);
}

// Judges `run` with the frames of Run::loose at their likely times, as early and as late as they
// can be, and without them, and with the lines of Run::slack_taps where they are, later by half of
// the slack, and by all of it. A failure or a weak finding remains if each of these orders has it;
// else it becomes inconclusive. Before the first common frame and after the last one it must be
// found without the loose files too, since their beginning and end are unknown.
Report judge_each_order(const Run& run, const Options& options) {
  Report report = judge_with(run, options, When::kLikely);
  if (std::none_of(report.findings.begin(), report.findings.end(), blames)) return report;
  const std::set<Name> early = blamed_in(judge_with(run, options, When::kEarly));
  const std::set<Name> late = blamed_in(judge_with(run, options, When::kLate));
  std::set<Name> never;
  if (!run.loose.empty()) never = blamed_in(judge_with(run, options, When::kNever));
  const auto [first_us, last_us] = between_of(run);
  for (Finding& finding : report.findings) {
    if (!blames(finding)) continue;
    const Name name = name_of(finding);
    // A frame that breaks a rule of the format breaks it at any time.
    const std::string_view id = reflect::requirement(finding.requirement).id;
    const LoosePlace* const place = place_of(run, finding.place);
    const std::int64_t at_us = finding.place.time_us;
    const bool between = place != nullptr ? place->between : at_us >= first_us && at_us <= last_us;
    const bool seen = run.loose.empty() || between || id.starts_with("WIRE-");
    const bool stands =
        early.contains(name) && late.contains(name) && (seen || never.contains(name));
    if (!stands) finding.severity = Severity::kInconclusive;
  }
  report.verdict = verdict_of(report.findings);
  return report;
}

constexpr std::int64_t kMuchLaterUs = 7'200'000'000;

// Returns the run with each step's frames as late as they can be, much later where nothing says how
// late that is, and frames with a wrong stamp so, too.
Run with_late_steps(const Run& run) {
  Run out = run;
  const auto later_us = [&](std::int64_t time_us) {
    std::int64_t sum_us = 0;
    for (const ClockStep& step : run.steps) {
      if (step.alone() || step.time_us > time_us) continue;
      sum_us += step.later_us == ClockStep::kUnknown ? kMuchLaterUs : step.later_us;
    }
    return sum_us;
  };
  for (ClockStep& step : out.steps) step.time_us += later_us(step.time_us);
  for (Observation& seen : out.seen) {
    if (!seen.place.in_order()) continue;
    const auto alone = std::find_if(run.steps.begin(), run.steps.end(), [&](const ClockStep& step) {
      return step.alone() && step.file == seen.place.file && step.frame == seen.place.frame;
    });
    if (alone != run.steps.end()) seen.place.time_us += alone->later_us;
    seen.place.time_us += later_us(seen.place.time_us);
  }
  merge(out);
  out.has_time = run.has_time;
  out.start_us = run.start_us + later_us(run.start_us);
  out.end_us = run.end_us + later_us(run.end_us);
  return out;
}

// Judges a run in which the clock of a recorder stepped, as if the frames after each step had come
// at once, and as late as they can have come. What only one of the two has is inconclusive.
Report judge_each_gap(const Run& run, const Options& options) {
  Report report = Judge(run, options).judge();
  Report late = Judge(with_late_steps(run), options).judge();
  const std::set<Name> soon_blamed = blamed_in(report);
  const std::set<Name> late_blamed = blamed_in(late);
  for (Finding& finding : report.findings) {
    if (!blames(finding) || late_blamed.contains(name_of(finding))) continue;
    finding.severity = Severity::kInconclusive;
  }
  std::map<std::pair<std::uint32_t, std::uint64_t>, const Place*> places;
  for (const Observation& seen : run.seen) {
    places[{seen.place.file, seen.place.frame}] = &seen.place;
  }
  const auto place_again = [&](Place& place) {
    const auto known = places.find({place.file, place.frame});
    place = known != places.end() ? *known->second : Place{};
  };
  for (Finding& finding : late.findings) {
    if (!blames(finding) || soon_blamed.contains(name_of(finding))) continue;
    finding.severity = Severity::kInconclusive;
    place_again(finding.place);
    place_again(finding.last);
    report.findings.push_back(std::move(finding));
  }
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const auto& a, const auto& b) {
                     return std::tie(a.place.time_us, a.place.file, a.place.frame) <
                            std::tie(b.place.time_us, b.place.file, b.place.frame);
                   });
  report.verdict = verdict_of(report.findings);
  return report;
}

// Judges a run of one clock. Where its frames show that stamps of the air or of lines are late, a
// failure must be found, too, with those of the other so much later; and where files do not have
// their frames in the order of the stamps, in this order as well.
Report judge_each_skew(const Run& run, const Options& options) {
  Report report = run.steps.empty() ? Judge(run, options).judge() : judge_each_gap(run, options);
  if (std::ranges::none_of(report.findings, blames)) return report;
  const TapsCross cross = Judge(run, options).taps_cross();
  const auto stands_with = [&](const auto& later_us) {
    Run now = run;
    for (Observation& seen : now.seen) {
      if (seen.node.empty() && seen.place.timed()) seen.place.time_us += later_us(seen);
    }
    merge(now);
    now.has_time = run.has_time;
    now.start_us = run.start_us;
    const std::set<Name> blamed = blamed_in(Judge(now, options).judge());
    for (Finding& finding : report.findings) {
      const bool stands = blamed.contains(name_of(finding));
      if (blames(finding) && !stands) finding.severity = Severity::kInconclusive;
    }
  };
  const auto moved = [&](machine::Link link, std::int64_t by_us) {
    if (by_us == 0) return;
    stands_with(
        [&](const Observation& seen) { return run.taps[seen.tap].link == link ? by_us + 1 : 0; });
  };
  moved(machine::Link::kSerial, cross.air_us);
  moved(machine::Link::kRadio, cross.line_us);
  std::int64_t most_us = 0;  // All others are later by this: the first frame may be turned.
  for (const auto& [frame, by_us] : run.turned) most_us = std::max(most_us, by_us);
  if (most_us > 0) {
    stands_with([&](const Observation& seen) {
      const auto turned = run.turned.find({seen.place.file, seen.place.frame});
      return turned == run.turned.end() ? most_us : most_us - turned->second;
    });
  }
  report.verdict = verdict_of(report.findings);
  return report;
}

// Moves the whole run to later times.
void move_all(Run& run, std::int64_t by_us) {
  const auto move = [by_us](std::int64_t time_us) { return time_us + by_us; };
  for (Observation& seen : run.seen) {
    if (seen.place.in_order()) seen.place.time_us += by_us;
  }
  for (LoosePlace& place : run.loose) place.early_us += by_us, place.late_us += by_us;
  for (ClockStep& step : run.steps) step.time_us += by_us;
  for (std::int64_t* const time_us : {&run.start_us, &run.end_us}) *time_us += by_us;
  move_nodes(run, std::nullopt, move);
}

// Returns the run without what logs say; with `unknown` of those alone whose clocks are not known.
Run without_logs(const Run& run, bool unknown) {
  Run out = run;
  for (const LogClock& log : run.logs) {
    if (unknown && log.known) continue;
    std::erase_if(out.seen, [&](const Observation& seen) { return seen.place.file == log.file; });
    for (LoggedNode& node : out.nodes) {
      if (node.file != log.file) continue;
      node.application = node.hearing = node.logged = node.whole = node.peis = false;
      node.busy.clear();
      node.link_acks_us.clear();
      node.link_failures_us.clear();
    }
  }
  return out;
}

// Findings that blame, `later_us` later than in the run that was given.
struct Blamed {
  std::vector<Finding> findings;
  std::int64_t later_us = 0;

  // Two files may show one frame, so that a finding of it lies in the one or in the other. An
  // episode may begin earlier here, by what is found here alone.
  bool has(const Finding& one, std::int64_t near_us) const {
    return std::ranges::any_of(findings, [&](const Finding& other) {
      if (!blames(other) || other.requirement != one.requirement || other.node != one.node) {
        return false;
      }
      const std::int64_t from_us = other.place.time_us - later_us - near_us;
      const std::int64_t to_us = other.last.time_us - later_us + near_us;
      const bool overlap = from_us <= one.last.time_us && one.place.time_us <= to_us;
      return overlap || name_of(other) == name_of(one);
    });
  }
};

// Returns what each log shows by itself: however far its clock is off, its own lines fit it, and
// where it stepped, those on either side of the step.
Blamed blamed_alone(const Run& run, Options options) {
  options.sniffer_complete = options.start_cold = false;  // Said of all of them together.
  Blamed out;
  const auto add = [&](const LogClock& log, std::uint64_t from, std::uint64_t to) {
    Run alone = run;
    alone.logs.clear();
    std::erase_if(alone.seen, [&](const Observation& seen) {
      const Place& place = seen.place;
      return place.file != log.file || place.frame < from || place.frame >= to;
    });
    std::erase_if(alone.nodes, [&](const LoggedNode& node) { return node.file != log.file; });
    for (LoggedNode& node : alone.nodes) node.whole = node.whole && log.step_frame == 0;
    merge(alone);
    std::ranges::move(judge(alone, options).findings, std::back_inserter(out.findings));
  };
  for (const LogClock& log : run.logs) {
    add(log, 0, log.step_frame == 0 ? UINT64_MAX : log.step_frame);
    if (log.step_frame != 0) add(log, log.step_frame, UINT64_MAX);
  }
  return out;
}

// Returns the findings of captures about nodes whose logs had not begun then, or were over. Nobody
// has recorded what happened in such a node at that time.
std::vector<Finding*> unlogged(const Run& run, Report& report) {
  using Span = std::pair<std::int64_t, std::int64_t>;
  std::map<std::uint32_t, Span> logs;
  for (const Observation& seen : run.seen) {
    const std::int64_t time_us = seen.place.time_us;
    if (!seen.place.timed() || seen.node.empty()) continue;
    Span& span = logs.emplace(seen.place.file, Span(time_us, time_us)).first->second;
    span = {std::min(span.first, time_us), std::max(span.second, time_us)};
  }
  std::vector<Finding*> out;
  for (Finding& finding : report.findings) {
    // An absence that no frame shows is judged where it is found, by how far the log goes.
    if (!blames(finding) || !finding.place.timed() || finding.place.frame == 0) continue;
    if (logs.contains(finding.place.file)) continue;
    if (finding.device >= run.nodes.size()) continue;
    const LoggedNode& node = run.nodes[finding.device];
    if (node.hearing || !logs.contains(node.file)) continue;
    const auto [from_us, to_us] = logs.at(node.file);
    const std::int64_t at_us = finding.place.time_us;
    if (at_us < from_us || at_us > to_us) out.push_back(&finding);
  }
  return out;
}

// Judges a run of several files, some of them logs. A failure or a weak finding remains if a log
// alone shows it, or if it is found at each time at which the logs may have begun, and without the
// logs whose clocks are not known, and without all logs where the node's had not begun or was over;
// else it becomes inconclusive.
Report judge_each_log(const Run& run, const Options& options) {
  const auto judged = [&](Run now, bool with_all = true) {
    now.logs.clear();
    const auto [start_us, end_us] = std::pair(now.start_us, now.end_us);
    merge(now);
    now.has_time = run.has_time;
    now.start_us = std::min(start_us, now.start_us);
    if (with_all) now.end_us = std::max(end_us, now.end_us);
    return judge(now, options);
  };
  Report report = judged(run);
  if (std::ranges::none_of(report.findings, blames)) return report;
  std::int64_t room_us = 0;  // A log that begins earlier makes the run longer.
  std::int64_t near_us = options.skew_us;
  for (const LogClock& log : run.logs) {
    room_us = std::max(room_us, log.earlier_us);
    near_us = std::max(near_us, log.earlier_us + log.later_us);
  }
  const Blamed alone = blamed_alone(run, options);
  const auto stands_in = [&](const Blamed& blamed) {
    for (Finding& finding : report.findings) {
      if (!blames(finding) || alone.has(finding, near_us) || blamed.has(finding, near_us)) continue;
      finding.severity = Severity::kInconclusive;
    }
  };
  constexpr int kPositions = 8;
  for (int at = 0; at <= kPositions; ++at) {
    Run now = run;
    move_all(now, room_us);
    for (const LogClock& log : run.logs) {
      const std::int64_t by_us = (log.earlier_us + log.later_us) * at / kPositions - log.earlier_us;
      move_log(now, log.file, [by_us](std::int64_t time_us) { return time_us + by_us; });
    }
    stands_in({judged(std::move(now)).findings, room_us});
  }
  if (!std::ranges::all_of(run.logs, &LogClock::known)) {
    stands_in({judged(without_logs(run, true), false).findings});
  }
  const std::vector<Finding*> open = unlogged(run, report);
  if (!open.empty()) {
    const Blamed captures{judged(without_logs(run, false), false).findings, 0};
    for (Finding* const finding : open) {
      if (alone.has(*finding, near_us) || captures.has(*finding, near_us)) continue;
      finding->severity = Severity::kInconclusive;
    }
  }
  report.verdict = verdict_of(report.findings);
  return report;
}

}  // namespace

TapsCross Context::find_taps_cross() const {
  using Key = std::pair<machine::Address, std::uint16_t>;  // Source and number.
  // Of a message: how often it came down a line and was not radiated since, and when a sink
  // radiated it before it came.
  struct Down {
    int waiting = 0;
    std::int64_t ahead_us = INT64_MIN / 2;
  };
  TapsCross out;
  std::map<Key, std::int64_t> up;  // When each was passed on.
  std::set<Key> sent;              // By its mote.
  std::map<Key, Down> down;
  const Observation* last = nullptr;  // Frame on the air.
  for (std::size_t i = run.past.senders.size(); i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    if (!seen.node.empty() || !seen.place.timed()) continue;
    const auto late = [&](std::int64_t& most_us, std::int64_t due_us) {
      const std::int64_t late_us = seen.place.time_us - due_us;
      if (late_us <= options.skew_us) most_us = std::max(most_us, late_us);
      return late_us <= options.skew_us;
    };
    const bool radio = seen.kind == Observation::Kind::kRadio;
    // An acknowledgement that comes late has a late stamp.
    const bool link_ack = seen.kind == Observation::Kind::kLinkAck && last != nullptr &&
                          last->tap == seen.tap && last->has_dsn && last->dsn == seen.dsn;
    if (link_ack) late(out.air_us, last->place.time_us + ack_within_us(*last));
    if (radio) last = &seen;
    Net net;
    if (!radio && seen.kind != Observation::Kind::kSerial) continue;
    if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) continue;
    const Key key(net.src, net.seq_num);
    if (!radio && !seen.to_mote) {
      up.try_emplace(key, seen.place.time_us);
    } else if (!radio) {
      Down& its = down[key];
      if (!late(out.line_us, std::exchange(its.ahead_us, INT64_MIN / 2))) ++its.waiting;
    } else if (seen.frame.src == net.src.devid && net.src.devid != sink_am) {
      const auto before = up.find(key);
      if (before != up.end() && !sent.contains(key)) late(out.air_us, before->second);
      sent.insert(key);
    } else if (seen.frame.src == sink_am && !who.marks[i].repeat) {
      // A sink has from its host alone what a PC sent, or what is for another island.
      const bool handed = net.src.devid == machine::kNullDevid ||
                          (net.src.pid != net.dest.pid && net.dest.pid != machine::kBroadcastPid);
      Down& its = down[key];
      if (its.waiting > 0) {
        --its.waiting;
      } else if (handed) {
        its.ahead_us = seen.place.time_us;
      }
    }
  }
  return out;
}

Report judge(const Run& run, const Options& options) {
  if (run.tells_all() && !(options.start_cold && options.sniffer_complete)) {
    Options known = options;
    known.start_cold = known.sniffer_complete = true;
    return judge(run, known);
  }
  if (!run.logs.empty()) return judge_each_log(run, options);
  if (!run.loose.empty() || !run.slack_taps.empty()) return judge_each_order(run, options);
  return judge_each_skew(run, options);
}

}  // namespace rubric::check
