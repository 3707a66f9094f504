// Collects findings: accepts differences of the profile, groups repeats, keeps within bounds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/reflect/requirements.h"
#include "conformance/check/finding.h"
#include "conformance/check/observation.h"

namespace rubric::check {

/// Counts the findings that are listed: so many of each severity that lesser ones keep no failure
/// out.
class Listed {
 public:
  static constexpr std::size_t kMost = 20'000;

  Listed() = default;
  explicit Listed(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings) ++counts_[index(finding)];
  }
  /// Returns whether the finding is to be listed, and counts it then.
  bool takes(const Finding& finding) {
    std::size_t& count = counts_[index(finding)];
    if (count >= kMost) return false;
    ++count;
    return true;
  }

 private:
  static std::size_t index(const Finding& finding) {
    return static_cast<std::size_t>(finding.severity);
  }

  std::array<std::size_t, static_cast<std::size_t>(Severity::kFail) + 1> counts_{};
};

class Findings {
 public:
  /// No episode goes on across one of `steps`, or one of the times `settled_us`.
  Findings(bool deployed, const std::vector<ClockStep>& steps,
           std::vector<std::int64_t> settled_us = {});

  /// Adds a finding. Repeats of a rule by a node within 600 ms of the last one are one episode. A
  /// difference that the profile accepts becomes a note.
  void add(Finding finding);
  /// Counts that a rule could have been broken and was kept.
  void kept(ReqId requirement) { ++kept_[reflect::requirement_index(requirement)]; }

  /// Returns the findings in order of place; dropped() counts those that did not fit.
  std::vector<Finding> take();
  std::uint64_t dropped() const { return dropped_; }
  std::vector<std::pair<ReqId, std::uint64_t>> exercised() const;

  static constexpr std::int64_t kEpisodeUs = 600'000;

 private:
  static constexpr std::int64_t kOpenUs = 5'000'000;  ///< Absences are found late.
  static constexpr std::size_t kOpenMax = 64;

  bool accepted(ReqId requirement) const;
  // Returns whether what came before is settled by then.
  bool settled(std::int64_t before_us, std::int64_t now_us) const;

  const std::vector<ClockStep>& steps_;
  std::vector<std::int64_t> settled_us_;
  bool deployed_ = false;
  std::vector<Finding> all_;
  Listed listed_;
  std::vector<std::size_t> open_;  // Episodes that may go on, in all_.
  std::uint64_t dropped_ = 0;
  std::vector<std::uint64_t> kept_;  // By place in the catalogue.
};

/// Returns the gravest verdict of all findings; notes leave a pass.
Verdict verdict_of(const std::vector<Finding>& findings);

}  // namespace rubric::check
