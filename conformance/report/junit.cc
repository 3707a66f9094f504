#include "conformance/report/junit.h"

#include <fmt/format.h>

#include <array>

#include "codec/text/text.h"

namespace rubric::report {
namespace {

using Outcome = JunitCase::Outcome;
using Sums = std::array<std::size_t, 4>;  // By outcome.

std::string attributes(const Sums& sums, const std::string& seconds) {
  const auto of = [&](Outcome outcome) { return sums[static_cast<std::size_t>(outcome)]; };
  return fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{}\"",
                     sums[0] + sums[1] + sums[2] + sums[3], of(Outcome::kFailure),
                     of(Outcome::kError), of(Outcome::kSkipped), seconds);
}

std::string outcome_element(const JunitCase& one) {
  if (one.outcome == Outcome::kPassed) return {};
  const std::string message = text::xml_text(one.message);
  if (one.outcome == Outcome::kSkipped) return fmt::format("<skipped message=\"{}\"/>\n", message);
  const char* const name = one.outcome == Outcome::kError ? "error" : "failure";
  const std::string head =
      fmt::format("<{} type=\"{}\" message=\"{}\"", name, text::xml_text(one.type), message);
  if (one.body.empty()) return head + "/>\n";
  return fmt::format("{}>{}</{}>\n", head, text::xml_text(one.body), name);
}

std::string output_element(const std::string& text) {
  return text.empty() ? "" : "<system-out>" + text::xml_text(text) + "</system-out>\n";
}

std::string testcase(const JunitCase& one) {
  std::string out = fmt::format("<testcase classname=\"{}\" name=\"{}\"",
                                text::xml_text(one.class_name), text::xml_text(one.name));
  if (!one.file.empty()) out += fmt::format(" file=\"{}\"", text::xml_text(one.file));
  out += fmt::format(" time=\"{}\"", one.seconds);
  const std::string inside = outcome_element(one) + output_element(one.output);
  return inside.empty() ? out + "/>\n" : out + ">\n" + inside + "</testcase>\n";
}

std::string properties(const JunitSuite& suite) {
  if (suite.properties.empty()) return {};
  std::string out = "<properties>\n";
  for (const auto& [name, value] : suite.properties) {
    out += fmt::format("<property name=\"{}\" value=\"{}\"/>\n", text::xml_text(name),
                       text::xml_text(value));
  }
  return out + "</properties>\n";
}

}  // namespace

std::string junit_seconds(double ms) { return fmt::format("{:.3f}", ms / 1000); }

std::string junit_document(const std::vector<JunitSuite>& suites, const std::string& name,
                           const std::string& seconds) {
  std::string text;
  Sums whole{};
  for (const JunitSuite& suite : suites) {
    Sums sums{};
    std::string cases;
    for (const JunitCase& one : suite.cases) {
      ++sums[static_cast<std::size_t>(one.outcome)];
      ++whole[static_cast<std::size_t>(one.outcome)];
      cases += testcase(one);
    }
    text += fmt::format("<testsuite name=\"{}\" {}>\n{}{}{}</testsuite>\n",
                        text::xml_text(suite.name), attributes(sums, suite.seconds),
                        properties(suite), cases, output_element(suite.output));
  }
  const std::string head = name.empty() ? ""
                                        : fmt::format(" name=\"{}\" {}", text::xml_text(name),
                                                      attributes(whole, seconds));
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites{}>\n{}</testsuites>\n", head, text);
}

}  // namespace rubric::report
