#include "conformance/suite/report/junit.h"

#include <algorithm>

#include <fmt/format.h>

#include "conformance/report/text.h"
#include "conformance/suite/report/words.h"

namespace rubric::suite {
namespace {

using report::xml_text;
using runner::CaseVerdict;

struct Sums {
  std::size_t tests = 0;
  std::size_t failures = 0;
  std::size_t errors = 0;
  std::size_t skipped = 0;
  double wall_ms = 0;

  void add(const Sums& other) {
    tests += other.tests;
    failures += other.failures;
    errors += other.errors;
    skipped += other.skipped;
    wall_ms += other.wall_ms;
  }
};

std::string attributes(const Sums& sums) {
  return fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\"",
                     sums.tests, sums.failures, sums.errors, sums.skipped, sums.wall_ms / 1000);
}

// Replaces dots, since readers split at the last one.
std::string class_name_of(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return "rubric." + name;
}

std::string outcome(const CaseRun& one, Sums& sums) {
  const std::string message = xml_text(headline(one));
  const std::string body = xml_text(in_full(one));
  if (one.unexpected() && one.result.verdict == CaseVerdict::kError) {
    ++sums.errors;
    return fmt::format("<error type=\"error\" message=\"{}\">{}</error>\n", message, body);
  }
  if (one.unexpected()) {
    ++sums.failures;
    const bool passes = one.expectation == Expectation::kUnexpectedPass;
    return fmt::format("<failure type=\"{}\" message=\"{}\">{}</failure>\n",
                       passes ? "unexpected_pass" : "fail", message, body);
  }
  if (one.expectation == Expectation::kAsExpected) {
    ++sums.skipped;
    return fmt::format("<skipped message=\"known: {}\"/>\n", xml_text(one.expected_reason));
  }
  if (is_undecided(one)) {
    ++sums.skipped;
    return fmt::format("<skipped message=\"{}: {}\"/>\n",
                       runner::verdict_text(one.result.verdict), message);
  }
  if (one.result.verdict == CaseVerdict::kWeak) return "<system-out>" + body + "</system-out>\n";
  return "";
}

std::string testcase(const std::string& class_name, const CaseRun& one, Sums& sums) {
  ++sums.tests;
  const std::string inside = outcome(one, sums);
  std::string out = fmt::format(
      "<testcase classname=\"{}\" name=\"{}\" file=\"{}\" time=\"{:.3f}\"", xml_text(class_name),
      xml_text(case_name(one)), xml_text(one.file), one.wall_ms / 1000);
  return inside.empty() ? out + "/>\n" : out + ">\n" + inside + "</testcase>\n";
}

// Reports faults between cases, and at the end, which belong to no case.
std::string outside(const std::string& class_name, const ImplementationRun& run, Sums& sums) {
  if (run.outside.empty()) return "";
  ++sums.tests;
  std::string body;
  for (const OutsideFault& one : run.outside) {
    body += xml_text(outside_text(one) + '\n' + one.stderr_text);
  }
  std::string inside = "<system-out>" + body + "</system-out>\n";
  if (broke_outside(run)) {
    ++sums.errors;
    inside = fmt::format("<error type=\"error\" message=\"{}\">{}</error>\n",
                         xml_text(outside_headline(run)), body);
  }
  return fmt::format("<testcase classname=\"{}\" name=\"outside_of_cases\" time=\"0\">\n"
                     "{}</testcase>\n", xml_text(class_name), inside);
}

// Returns a testsuite, whose numbers count in the whole, too.
std::string suite_element(const std::string& name, const Sums& sums, const std::string& body,
                          Sums& whole) {
  whole.add(sums);
  return fmt::format("<testsuite name=\"{}\" {}>\n{}</testsuite>\n", xml_text(name),
                     attributes(sums), body);
}

std::string stale_suite(const SuiteRun& run, Sums& whole) {
  if (run.stale.empty()) return "";
  Sums sums;
  std::string body;
  for (const StaleExpectation& one : run.stale) {
    ++sums.tests;
    ++sums.failures;
    body += fmt::format("<testcase classname=\"rubric.expectations\" name=\"{}\" time=\"0\">\n"
                        "<failure type=\"stale\" message=\"{}\"/>\n</testcase>\n",
                        xml_text(one.place), xml_text(one.text));
  }
  return suite_element("rubric test: expectations", sums, body, whole);
}

}  // namespace

std::string junit_report(const SuiteRun& run) {
  std::string suites;
  Sums whole;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const ImplementationRun& one = run.implementations[i];
    const std::string name = implementation_name(run, i);
    const std::string class_name = class_name_of(name);
    Sums sums;
    sums.wall_ms = one.wall_ms;
    std::string body;
    if (!one.dishonest.empty()) {
      ++sums.tests;
      ++sums.errors;
      body += fmt::format("<testcase classname=\"{0}\" name=\"honesty\" time=\"0\">\n"
                          "<error type=\"error\" message=\"{1}\"/>\n</testcase>\n",
                          xml_text(class_name), xml_text(one.dishonest));
    }
    for (const CaseRun& each : one.cases) body += testcase(class_name, each, sums);
    body += outside(class_name, one, sums);
    suites += suite_element("rubric test: " + name, sums, body, whole);
  }
  suites += stale_suite(run, whole);
  return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                     "<testsuites name=\"rubric test\" {}>\n{}</testsuites>\n",
                     attributes(whole), suites);
}

}  // namespace rubric::suite
