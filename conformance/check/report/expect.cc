#include "conformance/check/report/expect.h"

#include <fnmatch.h>

#include <algorithm>

#include "codec/reflect/fault_text.h"

namespace rubric::report {
namespace {

using check::Finding;
using check::Severity;

bool glob_matches(const std::string& glob, const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  return ::fnmatch(glob.c_str(), path.c_str(), 0) == 0 ||
         ::fnmatch(glob.c_str(), name.c_str(), 0) == 0;
}

bool applies(const KnownFailure& one, const check::Run& run, bool deployed) {
  if (!one.profile.empty() && (one.profile == "deployed") != deployed) return false;
  return one.file.empty() ||
         std::any_of(run.files.begin(), run.files.end(),
                     [&](const std::string& file) { return glob_matches(one.file, file); });
}

ReqId rule_of(const KnownFailure& one) { return reflect::find_requirement(one.requirement); }

// All but the message agrees.
bool is_about(const KnownFailure& one, const check::Run& run, const Finding& finding) {
  const Severity severity = finding.severity;
  if (severity != Severity::kFail && severity != Severity::kInconclusive) return false;
  if (finding.requirement != rule_of(one)) return false;
  if (!one.node.empty() && finding.node != one.node) return false;
  return one.file.empty() || (finding.place.file < run.files.size() &&
                              glob_matches(one.file, run.files[finding.place.file]));
}

}  // namespace

std::string_view state_name(ExpectationState state) {
  switch (state) {
    case ExpectationState::kMatched: return "matched";
    case ExpectationState::kStale: return "stale";
    case ExpectationState::kOtherMessage: return "other_message";
    case ExpectationState::kNotApplicable: return "not_applicable";
  }
  return "not_applicable";
}

KnownFailures parse_expectations(std::string_view text, const std::string& name) {
  KnownFailures out = parse_known_failures(text, name, KnownTo::kCheck, [](const auto& rule) {
    const bool known = reflect::find_requirement(rule) != ReqId::kNone;
    return known ? std::string() : "no requirement is called '" + rule + "'";
  });
  for (KnownFailure& one : out.entries) one.requirement = reflect::requirement(rule_of(one)).id;
  return out;
}

Outcome compare(const check::Run& run, const check::Options& options, const check::Report& report,
                const KnownFailures& known) {
  Outcome out;
  out.expected_by.assign(report.findings.size(), kUnexpected);
  for (std::size_t e = 0; e < known.entries.size(); ++e) {
    const KnownFailure& one = known.entries[e];
    ExpectationResult result;
    if (applies(one, run, options.deployed)) {
      std::vector<std::size_t> others;
      bool open = false;  // It is seen, but not proven.
      for (std::size_t i = 0; i < report.findings.size(); ++i) {
        const Finding& finding = report.findings[i];
        if (!is_about(one, run, finding)) continue;
        const bool same = has_tokens(finding.text, one.message);
        if (finding.severity == Severity::kInconclusive) {
          open = open || same;
          continue;
        }
        (same ? result.findings : others).push_back(i);
        if (same && out.expected_by[i] == kUnexpected) out.expected_by[i] = e;
      }
      if (!result.findings.empty()) {
        result.state = ExpectationState::kMatched;
      } else if (others.empty()) {
        result.state = open ? ExpectationState::kNotApplicable : ExpectationState::kStale;
      } else {
        result.state = ExpectationState::kOtherMessage;
      }
      if (result.findings.empty()) result.findings = std::move(others);
      const bool untrue = result.state == ExpectationState::kStale ||
                          result.state == ExpectationState::kOtherMessage;
      out.broken_expectations += untrue ? 1 : 0;
    }
    out.results.push_back(std::move(result));
  }
  bool decided = !report.exercised.empty();
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const Severity severity = report.findings[i].severity;
    const bool failed = severity == Severity::kFail;
    if (failed && out.expected_by[i] == kUnexpected) ++out.unexpected_failures;
    decided = decided || failed || severity == Severity::kWeak;
  }
  out.nothing_judged = !decided;
  out.verdict = decided ? report.verdict : check::Verdict::kInconclusive;
  return out;
}

}  // namespace rubric::report
