#include "conformance/test/report/junit.h"

#include <fmt/format.h>

#include <algorithm>

#include "conformance/report/junit.h"
#include "conformance/test/report/words.h"

namespace rubric::suite {
namespace {

using report::JunitCase;
using report::JunitSuite;
using runner::CaseVerdict;
using Outcome = JunitCase::Outcome;

// Replaces dots, since readers split at the last one.
std::string class_name_of(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return "rubric." + name;
}

// A case about the run as a whole.
JunitCase whole(const std::string& class_name, const char* name, Outcome outcome, const char* type,
                const std::string& message) {
  JunitCase out{.class_name = class_name, .name = name};
  out.outcome = outcome;
  out.type = type;
  out.message = message;
  return out;
}

JunitCase testcase(const std::string& class_name, const CaseRun& one) {
  JunitCase out{.class_name = class_name, .name = case_name(one), .file = one.file};
  out.seconds = report::junit_seconds(one.wall_ms);
  if (one.unexpected()) {
    const bool broke = one.result.verdict == CaseVerdict::kError;
    const bool passes = one.expectation == Expectation::kUnexpectedPass;
    out.outcome = broke ? Outcome::kError : Outcome::kFailure;
    out.type = broke ? "error" : one.owed ? "incomplete" : passes ? "unexpected_pass" : "fail";
    out.message = headline(one);
    out.body = in_full(one);
  } else if (one.expectation == Expectation::kAsExpected) {
    out.outcome = Outcome::kSkipped;
    out.message = "known: " + one.expected_reason;
  } else if (one.undecided()) {
    out.outcome = Outcome::kSkipped;
    out.message = fmt::format("{}: {}", runner::verdict_text(one.result.verdict),
                              one.expected_reason.empty() ? headline(one) : one.expected_reason);
    if (!one.result.failures.empty()) out.output = in_full(one);
  } else if (one.result.verdict == CaseVerdict::kWeak) {
    out.output = in_full(one);
  }
  return out;
}

// Returns the faults between cases and at the end, as a case of their own.
JunitCase outside(const std::string& class_name, const ImplementationRun& run) {
  std::string text;
  for (const OutsideFault& one : run.outside) text += outside_text(one) + '\n' + one.stderr_text;
  JunitCase out{.class_name = class_name, .name = "outside_of_cases"};
  if (broke_outside(run)) {
    out = whole(class_name, "outside_of_cases", Outcome::kError, "error", outside_headline(run));
    out.body = text;
  } else {
    out.output = text;
  }
  return out;
}

JunitSuite stale_suite(const SuiteRun& run) {
  JunitSuite out{.name = "rubric test: expectations", .seconds = report::junit_seconds(0)};
  for (const StaleExpectation& one : run.stale) {
    JunitCase& added = out.cases.emplace_back();
    added.class_name = "rubric.expectations";
    added.name = one.place;
    added.outcome = Outcome::kFailure;
    added.type = "stale";
    added.message = one.text;
  }
  return out;
}

}  // namespace

std::string junit_report(const SuiteRun& run) {
  std::vector<JunitSuite> suites;
  double wall_ms = 0;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const ImplementationRun& one = run.implementations[i];
    const std::string name = implementation_name(run, i);
    const std::string class_name = class_name_of(name);
    JunitSuite& suite = suites.emplace_back();
    suite.name = "rubric test: " + name;
    suite.seconds = report::junit_seconds(one.wall_ms);
    wall_ms += one.wall_ms;
    if (!one.dishonest.empty()) {
      suite.cases.push_back(whole(class_name, "honesty", Outcome::kError, "error", one.dishonest));
    }
    for (const CaseRun& each : one.cases) suite.cases.push_back(testcase(class_name, each));
    if (!one.outside.empty()) suite.cases.push_back(outside(class_name, one));
    if (const std::string missing = incomplete_as_a_whole(run, one); !missing.empty()) {
      suite.cases.push_back(
          whole(class_name, "completeness", Outcome::kFailure, "incomplete", missing));
    }
  }
  if (!run.stale.empty()) suites.push_back(stale_suite(run));
  return report::junit_document(suites, "rubric test", report::junit_seconds(wall_ms));
}

}  // namespace rubric::suite
