// What becomes of findings while a run grows and is judged again and again.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// News of one finding.
struct Change {
  enum class What : std::uint8_t {
    kFound,      ///< It stands, and was not told before.
    kChanged,    ///< It was told with another severity.
    kWithdrawn,  ///< It was told, and what came since says otherwise.
  };
  What what = What::kFound;
  Finding finding;               ///< kWithdrawn: as it was told.
  Severity before = Severity::kNote;  ///< kChanged: as it was told.
  std::string why;               ///< kWithdrawn: what came, the end of a sentence.
};

/// Tells each finding once it has stood for a while: what follows a frame within the time that a
/// node may take, or waits in another tap's buffer, may still explain it.
class Watch {
 public:
  explicit Watch(std::int64_t settle_us) : settle_us_(settle_us) {}

  /// The newest report, or the last one again while nothing comes; `now_us` is any clock that goes
  /// on steadily. What is withdrawn first, else in order of place.
  std::vector<Change> update(const Report& report, std::int64_t now_us);

 private:
  /// File, frame, rule, node, and which of several such.
  using Key = std::tuple<std::uint32_t, std::uint64_t, std::size_t, std::string, std::uint32_t>;
  struct Known {
    std::int64_t since_us = 0;
    bool told = false;
    bool stands = true;  // In the newest report.
    Finding finding;     // As it was told.
  };

  void look(const Finding& finding, Known& known, std::int64_t now_us, std::vector<Change>& out);
  std::string reason(const Finding& finding, const Report& report) const;

  std::int64_t settle_us_;
  std::map<Key, Known> known_;
  std::set<std::string> facts_;  // Of the report before: what they are about.
};

}  // namespace rubric::oracle
