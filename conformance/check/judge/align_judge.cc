#include "conformance/check/judge/align_judge.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/judge/findings.h"

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

}  // namespace

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

}  // namespace rubric::check
