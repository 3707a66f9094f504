// What a report calls a failure, as text that tests compare.
#pragma once

#include <set>
#include <string>

#include "codec/reflect/requirements.h"
#include "conformance/check/judge/judge.h"

namespace rubric::check {

/// Returns "RULE node frame" for each failure.
inline std::multiset<std::string> failures_of(const Report& report) {
  std::multiset<std::string> out;
  for (const Finding& finding : report.findings) {
    if (finding.severity != Severity::kFail) continue;
    out.insert(reflect::requirement(finding.requirement).id + std::string(" ") + finding.node +
               " " + std::to_string(finding.place.frame));
  }
  return out;
}

}  // namespace rubric::check
