#include "conformance/check/judge/findings.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "conformance/check/terms.h"
#include "conformance/generated/profiles.h"

namespace rubric::check {
Findings::Findings(bool deployed, const std::vector<ClockStep>& steps,
                   std::vector<std::int64_t> settled_us)
    : steps_(steps),
      settled_us_(std::move(settled_us)),
      deployed_(deployed),
      kept_(reflect::requirements().size()) {}

bool Findings::accepted(ReqId requirement) const {
  for (const machine::AcceptedDifference& difference : profile_of(deployed_).accepted) {
    if (difference.requirement == requirement) return true;
  }
  return false;
}

bool Findings::settled(std::int64_t before_us, std::int64_t now_us) const {
  return std::any_of(settled_us_.begin(), settled_us_.end(), [&](std::int64_t time_us) {
    return before_us < time_us && time_us <= now_us;
  });
}

void Findings::add(Finding finding) {
  if (finding.severity > Severity::kNote && !finding.beyond && accepted(finding.requirement)) {
    finding.severity = Severity::kNote;
  }
  std::erase_if(open_, [&](std::size_t i) {
    return finding.place.time_us >= 0 && all_[i].last.time_us + kOpenUs < finding.place.time_us;
  });
  if (finding.count == 1) finding.last = finding.place;
  for (const std::size_t i : open_) {
    Finding& before = all_[i];
    if (before.requirement != finding.requirement || before.severity != finding.severity ||
        before.node != finding.node || before.place.file != finding.place.file ||
        finding.place.time_us - before.last.time_us > kEpisodeUs ||
        stepped(steps_, before.last.time_us, finding.place.time_us) ||
        settled(before.last.time_us, finding.place.time_us)) {
      continue;
    }
    ++before.count;
    before.last = finding.place;
    return;
  }
  if (!listed_.takes(finding)) {
    ++dropped_;
    return;
  }
  if (open_.size() >= kOpenMax) open_.erase(open_.begin());
  open_.push_back(all_.size());
  all_.push_back(std::move(finding));
}

std::vector<Finding> Findings::take() {
  std::stable_sort(all_.begin(), all_.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.place.time_us, a.place.file, a.place.frame) <
           std::tie(b.place.time_us, b.place.file, b.place.frame);
  });
  open_.clear();
  return std::move(all_);
}

std::vector<std::pair<ReqId, std::uint64_t>> Findings::exercised() const {
  std::vector<std::pair<ReqId, std::uint64_t>> out;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i] > 0) out.emplace_back(reflect::requirements()[i].number(), kept_[i]);
  }
  return out;
}

Verdict verdict_of(const std::vector<Finding>& findings) {
  Severity worst = Severity::kNote;
  for (const Finding& finding : findings) worst = std::max(worst, finding.severity);
  return static_cast<Verdict>(worst);  // They are in one order, and notes alone pass.
}

}  // namespace rubric::check
