#include "conformance/oracle/report/json.h"

#include <fmt/format.h>

#include <array>

#include "codec/reflect/fault_text.h"
#include "conformance/oracle/report/words.h"

namespace rubric::report {
namespace {

using oracle::Finding;
using oracle::Severity;

std::string number_or_null(std::uint64_t number) {
  return number == 0 ? "null" : std::to_string(number);
}

std::string time_json(std::int64_t time_us) {
  const std::string text = seconds_text(time_us);
  return text.empty() ? "null" : text;
}

// Prints "[" items "]", each item on a line of its own.
template <class Items, class ToText>
std::string list(const Items& items, ToText to_text) {
  std::string out = "[";
  bool first = true;
  for (const auto& item : items) {
    out += first ? "\n  " : ",\n  ";
    out += to_text(item);
    first = false;
  }
  return out + (first ? "]" : "\n]");
}

std::string hypotheses_json(const Finding& finding) {
  std::string out = "[";
  for (const oracle::Hypothesis& h : finding.hypotheses) {
    out += fmt::format("{}{{\"text\":{},\"allowed\":{},\"miss\":{}}}", out.size() > 1 ? "," : "",
                       json_string(h.text), json_string(h.allowed), json_string(h.miss));
  }
  return out + "]";
}

std::string expectations_json(const Story& story) {
  std::vector<std::size_t> all(story.outcome.results.size());
  for (std::size_t e = 0; e < all.size(); ++e) all[e] = e;
  return list(all, [&](std::size_t e) {
    const ExpectationResult& result = story.outcome.results[e];
    const Expectation& one = story.expected.expectations[e];
    return fmt::format(
        "{{\"requirement\":{},\"line\":{},\"message\":{},\"reason\":{},\"came\":\"{}\","
        "\"findings\":[{}]}}",
        json_string(reflect::requirement(one.requirement).id), one.line,
        json_string(one.message), json_string(one.reason), came_name(result.came),
        fmt::join(result.findings, ","));
  });
}

std::string counts_json(const Story& story) {
  std::array<std::uint64_t, 5> counts{};
  std::uint64_t known = 0;
  for (std::size_t i = 0; i < story.report.findings.size(); ++i) {
    ++counts[static_cast<std::size_t>(story.report.findings[i].severity)];
    if (story.outcome.expected_by[i] != kUnexpected) ++known;
  }
  const auto count = [&](Severity s) { return counts[static_cast<std::size_t>(s)]; };
  return fmt::format(
      "{{\"frames\":{},\"fail\":{},\"weak\":{},\"stray\":{},\"inconclusive\":{},\"note\":{},"
      "\"known_failures\":{},\"unexpected_failures\":{},\"broken_expectations\":{},"
      "\"rules_exercised\":{}}}",
      story.report.frames, count(Severity::kFail), count(Severity::kWeak),
      count(Severity::kStray), count(Severity::kInconclusive), count(Severity::kNote), known,
      story.outcome.unexpected_failures, story.outcome.broken_expectations,
      story.report.exercised.size());
}

}  // namespace

std::string json_finding(const Story& story, std::size_t index) {
  const Finding& finding = story.report.findings[index];
  const reflect::Requirement& rule = reflect::requirement(finding.requirement);
  const auto& files = story.run.files;
  const std::size_t by = story.outcome.expected_by[index];
  const bool is_expected = by != kUnexpected;
  const bool has_frame = finding.place.frame != 0;
  return fmt::format(
      "{{\"requirement\":{},\"level\":{},\"sentence\":{},\"severity\":\"{}\",\"time\":{},"
      "\"file\":{},\"frame\":{},\"offset\":{},\"node\":{},\"text\":{},\"expected\":{},"
      "\"count\":{},\"last_frame\":{},\"known\":{},\"hypotheses\":{}}}",
      json_string_or_null(rule.id), json_string_or_null(rule.level),
      json_string_or_null(rule.sentence), severity_name(finding.severity),
      time_json(finding.place.time_us),
      finding.place.file < files.size() ? json_string(files[finding.place.file]) : "null",
      number_or_null(finding.place.frame),
      has_frame ? std::to_string(finding.place.offset_bytes) : "null",
      json_string_or_null(finding.node), json_string(finding.text), json_string(finding.expected),
      finding.count, number_or_null(finding.last.frame),
      is_expected ? json_string(story.expected.expectations[by].reason) : "null",
      hypotheses_json(finding));
}

std::string json_report(const Story& story) {
  std::vector<std::size_t> indices(story.report.findings.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = i;
  const oracle::Options& o = story.options;
  std::string out = fmt::format(
      "{{\"schema\":\"rubric.check/1\",\n\"verdict\":\"{}\",\n\"expected\":{},\n\"exit_code\":{},\n"
      "\"profile\":\"{}\",\n\"sniffer\":\"{}\",\n\"start\":\"{}\",\n",
      verdict_name(story.outcome.verdict), story.outcome.as_expected(), story.outcome.exit_code(),
      o.deployed ? "deployed" : "paper", o.sniffer_complete ? "complete" : "unknown",
      o.start_cold ? "cold" : "unknown");
  out += "\"files\":" + list(story.run.files, json_string) + ",\n";
  out += "\"findings\":" +
         list(indices, [&](std::size_t i) { return json_finding(story, i); }) + ",\n";
  out += "\"counts\":" + counts_json(story) + ",\n";
  out += "\"facts\":" + list(story.report.facts, json_string) + ",\n";
  out += "\"exercised\":" + list(story.report.exercised, [](const auto& one) {
           return fmt::format("{{\"requirement\":{},\"count\":{}}}",
                              json_string(reflect::requirement(one.first).id), one.second);
         });
  if (!story.expected.name.empty()) out += ",\n\"expectations\":" + expectations_json(story);
  return out + "}\n";
}

}  // namespace rubric::report
