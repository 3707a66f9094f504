#include "conformance/oracle/report/expect.h"

#include <fnmatch.h>

#include <algorithm>
#include <stdexcept>

#include "codec/reflect/fault_text.h"
#include "conformance/report/entries.h"

namespace rubric::report {
namespace {

using oracle::Finding;
using oracle::Severity;

std::string mistake(std::string_view key, const std::string& value) {
  if (key == "requirement" && reflect::find_requirement(value) == ReqId::kNone) {
    return "no requirement is called '" + value + "'";
  }
  if (key == "profile" && value != "paper" && value != "deployed") {
    return "profile is paper or deployed, not '" + value + "'";
  }
  return {};
}

bool glob_matches(const std::string& glob, const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  return ::fnmatch(glob.c_str(), path.c_str(), 0) == 0 ||
         ::fnmatch(glob.c_str(), name.c_str(), 0) == 0;
}

bool applies(const Expectation& one, const oracle::Run& run, bool deployed) {
  if (!one.profile.empty() && (one.profile == "deployed") != deployed) return false;
  return one.file.empty() ||
         std::any_of(run.files.begin(), run.files.end(),
                     [&](const std::string& file) { return glob_matches(one.file, file); });
}

// Returns whether all but the message agrees.
bool is_about(const Expectation& one, const oracle::Run& run, const Finding& finding) {
  if (finding.severity != Severity::kFail || finding.requirement != one.requirement) return false;
  if (!one.node.empty() && finding.node != one.node) return false;
  return one.file.empty() || (finding.place.file < run.files.size() &&
                              glob_matches(one.file, run.files[finding.place.file]));
}

}  // namespace

std::string_view came_name(Came came) {
  switch (came) {
    case Came::kTrue: return "matched";
    case Came::kStale: return "stale";
    case Came::kOtherMessage: return "other_message";
    case Came::kNotAsked: return "not_applicable";
  }
  return "not_applicable";
}

bool parse_expectations(std::string_view text, const std::string& name, ExpectationFile& out,
                        std::string& error) {
  const EntryForm form{"expectations",
                       {"requirement", "message", "reason"},
                       {"requirement", "node", "file", "profile", "message", "reason"},
                       mistake};
  out = {name, {}};
  try {
    for (const Entry& one : parse_entries(text, name, form)) {
      out.expectations.push_back({reflect::find_requirement(one.text("requirement")),
                                  one.text("node"), one.text("file"), one.text("profile"),
                                  one.text("message"), one.text("reason"), one.line});
    }
  } catch (const std::runtime_error& refused) {
    error = refused.what();
    return false;
  }
  return true;
}

Outcome compare(const oracle::Run& run, const oracle::Options& options,
                const oracle::Report& report, const ExpectationFile& file) {
  Outcome out;
  out.expected_by.assign(report.findings.size(), kUnexpected);
  for (std::size_t e = 0; e < file.expectations.size(); ++e) {
    const Expectation& one = file.expectations[e];
    ExpectationResult result;
    if (applies(one, run, options.deployed)) {
      std::vector<std::size_t> others;
      for (std::size_t i = 0; i < report.findings.size(); ++i) {
        const Finding& finding = report.findings[i];
        if (!is_about(one, run, finding)) continue;
        const bool same = finding.text.find(one.message) != std::string::npos;
        (same ? result.findings : others).push_back(i);
        if (same && out.expected_by[i] == kUnexpected) out.expected_by[i] = e;
      }
      result.came = !result.findings.empty() ? Came::kTrue
                    : others.empty()         ? Came::kStale
                                             : Came::kOtherMessage;
      if (result.findings.empty()) result.findings = std::move(others);
      if (result.came != Came::kTrue) ++out.broken_expectations;
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
  out.verdict = decided ? report.verdict : oracle::Verdict::kInconclusive;
  return out;
}

}  // namespace rubric::report
