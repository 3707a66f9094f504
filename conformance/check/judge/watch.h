// Follows findings while a run grows and is judged again and again.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "conformance/check/observation.h"

namespace rubric::check {

/// News of one finding.
struct Change {
  enum class What : std::uint8_t {
    kFound,      ///< It holds, and was not reported before.
    kChanged,    ///< It was reported with another severity.
    kWithdrawn,  ///< It was reported, and later frames disprove it.
  };
  What what = What::kFound;
  Finding finding;                    ///< kWithdrawn: as it was reported.
  Severity before = Severity::kNote;  ///< kChanged: as it was reported.
  std::string why;                    ///< kWithdrawn: what came, the end of a sentence.
};

/// Reports each finding once it has held for a while: a later frame within the time that a node may
/// take, or one waiting in another tap's buffer, may still explain it.
class Watch {
 public:
  explicit Watch(std::int64_t settle_us) : settle_us_(settle_us) {}

  /// Takes the newest report, or the last one again while nothing comes; `now_us` is any steady
  /// clock. Returns withdrawn findings first, the others in order of place.
  std::vector<Change> update(const Report& report, std::int64_t now_us);

 private:
  /// File, frame, rule, node, and a number among equal ones.
  using Key = std::tuple<std::uint32_t, std::uint64_t, std::size_t, std::string, std::uint32_t>;
  struct Known {
    std::int64_t since_us = 0;
    bool told = false;
    bool stands = true;  // In the newest report.
    Finding finding;     // As it was reported.
  };

  void look(const Finding& finding, Known& known, std::int64_t now_us, std::vector<Change>& out);
  std::string reason(const Finding& finding, const Report& report) const;

  std::int64_t settle_us_;
  std::map<Key, Known> known_;
  std::set<std::string> facts_;  // Subjects of the report before.
};

}  // namespace rubric::check
