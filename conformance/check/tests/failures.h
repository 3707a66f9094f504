// The findings of a report as text, for tests to compare.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "codec/reflect/requirements.h"
#include "conformance/check/observation.h"

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

/// Returns the rules of findings of at least that severity, in order.
inline std::string rules_of(const std::vector<Finding>& findings,
                            Severity least = Severity::kNote) {
  std::string out;
  for (const Finding& finding : findings) {
    if (finding.severity < least) continue;
    out += std::string(out.empty() ? "" : " ") + reflect::requirement(finding.requirement).id;
  }
  return out;
}

/// Returns the options of a recording that is complete, from the start on.
inline Options complete() { return {.sniffer_complete = true, .start_cold = true}; }

/// Returns the rules that a report finds broken, in order; of a SHOULD it says so. Tests have short
/// messages on their serial lines, so that they can be read: that alone is not said.
inline std::string broken_in(const Report& report) {
  std::string out;
  for (const Finding& finding : report.findings) {
    const bool weak = finding.severity == Severity::kWeak;
    if (finding.severity != Severity::kFail && !weak) continue;
    if (finding.requirement == "N11-WHOLE"_rule) continue;
    if (!out.empty()) out += " ";
    out += reflect::requirement(finding.requirement).id;
    if (weak) out += " (weak)";
  }
  return out;
}

}  // namespace rubric::check
