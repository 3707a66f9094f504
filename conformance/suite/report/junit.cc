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
};

// Readers split at the last dot.
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

std::string suite_element(const std::string& name, double wall_ms, const Sums& sums,
                          const std::string& body) {
  return fmt::format("<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" "
                     "skipped=\"{}\" time=\"{:.3f}\">\n{}</testsuite>\n",
                     xml_text(name), sums.tests, sums.failures, sums.errors, sums.skipped,
                     wall_ms / 1000, body);
}

std::string stale_suite(const SuiteRun& run) {
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
  return suite_element("rubric test: expectations", 0, sums, body);
}

}  // namespace

std::string junit_report(const SuiteRun& run) {
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const ImplementationRun& one = run.implementations[i];
    const std::string name = implementation_name(run, i);
    const std::string class_name = class_name_of(name);
    Sums sums;
    std::string body;
    if (!one.dishonest.empty()) {
      ++sums.tests;
      ++sums.errors;
      body += fmt::format("<testcase classname=\"{0}\" name=\"honesty\" time=\"0\">\n"
                          "<error type=\"error\" message=\"{1}\"/>\n</testcase>\n",
                          xml_text(class_name), xml_text(one.dishonest));
    }
    for (const CaseRun& each : one.cases) body += testcase(class_name, each, sums);
    out += suite_element("rubric test: " + name, one.wall_ms, sums, body);
  }
  return out + stale_suite(run) + "</testsuites>\n";
}

}  // namespace rubric::suite
