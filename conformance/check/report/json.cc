#include "conformance/check/report/json.h"

#include <array>
#include <numeric>

#include "codec/reflect/fault_text.h"
#include "conformance/check/report/words.h"

namespace rubric::report {
namespace {

using check::Finding;
using check::Severity;

text::Json or_null(std::uint64_t number) {
  return number == 0 ? text::Json::raw("") : text::Json(number);
}

// Each item in a line of its own.
template <class Items, class ToJson = std::identity>
text::Json lines(const Items& items, ToJson to_json = {}) {
  return text::Json::array(items, to_json, "\n  ", "\n");
}

std::vector<std::size_t> indices(std::size_t count) {
  std::vector<std::size_t> out(count);
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

text::Json hypothesis_json(const check::Hypothesis& one) {
  return text::Json::object({{"text", one.text}, {"allowed", one.allowed}, {"miss", one.miss}});
}

text::Json expectation_json(const Story& story, std::size_t e) {
  const ExpectationResult& result = story.outcome.results[e];
  const KnownFailure& one = story.expected.entries[e];
  return text::Json::object({{"requirement", one.requirement},
                             {"line", one.line},
                             {"message", one.message},
                             {"reason", one.reason},
                             {"came", state_name(result.state)},
                             {"findings", text::Json::array(result.findings)}});
}

text::Json counts_json(const Story& story) {
  std::array<std::uint64_t, 5> counts{};
  std::uint64_t known = 0;
  for (std::size_t i = 0; i < story.report.findings.size(); ++i) {
    ++counts[static_cast<std::size_t>(story.report.findings[i].severity)];
    if (story.outcome.expected_by[i] != kUnexpected) ++known;
  }
  text::Json::Members out = {{"frames", story.report.frames}};
  for (const Severity severity : {Severity::kFail, Severity::kWeak, Severity::kStray,
                                  Severity::kInconclusive, Severity::kNote}) {
    out.emplace_back(severity_name(severity), counts[static_cast<std::size_t>(severity)]);
  }
  out.emplace_back("known_failures", known);
  out.emplace_back("unexpected_failures", story.outcome.unexpected_failures);
  out.emplace_back("broken_expectations", story.outcome.broken_expectations);
  out.emplace_back("rules_exercised", story.report.exercised.size());
  return text::Json::object(out);
}

}  // namespace

text::Json json_finding(const Story& story, std::size_t index) {
  const Finding& finding = story.report.findings[index];
  const reflect::Requirement& rule = reflect::requirement(finding.requirement);
  const auto& files = story.run.files;
  const check::Place& place = finding.place;
  const std::size_t by = story.outcome.expected_by[index];
  return text::Json::object(
      {{"requirement", text::Json::or_null(rule.id)},
       {"level", text::Json::or_null(rule.level)},
       {"sentence", text::Json::or_null(rule.sentence)},
       {"severity", severity_name(finding.severity)},
       {"time", text::Json::raw(text::seconds_text(place.time_us))},
       {"file", place.file < files.size() ? text::Json(files[place.file]) : text::Json::raw("")},
       {"frame", or_null(place.frame)},
       {"offset", place.frame != 0 ? text::Json(place.offset_bytes) : text::Json::raw("")},
       {"node", text::Json::or_null(finding.node)},
       {"text", finding.text},
       {"expected", finding.expected},
       {"count", finding.count},
       {"last_frame", or_null(finding.last.frame)},
       {"known",
        by != kUnexpected ? text::Json(story.expected.entries[by].reason) : text::Json::raw("")},
       {"hypotheses", text::Json::array(finding.hypotheses, hypothesis_json)}});
}

text::Json json_report(const Story& story) {
  const check::Options& o = story.options;
  const check::Report& report = story.report;
  const auto finding = [&](std::size_t i) { return json_finding(story, i); };
  const auto expectation = [&](std::size_t e) { return expectation_json(story, e); };
  const auto exercised = [](const auto& one) {
    return text::Json::object(
        {{"requirement", reflect::requirement(one.first).id}, {"count", one.second}});
  };
  text::Json::Members out = {{"schema", "rubric.check/1"},
                             {"verdict", verdict_name(story.outcome.verdict)},
                             {"expected", story.outcome.as_expected()},
                             {"exit_code", story.outcome.exit_code()},
                             {"input_missing", story.outcome.input_missing},
                             {"profile", o.deployed ? "deployed" : "paper"},
                             {"sniffer", o.sniffer_complete ? "complete" : "unknown"},
                             {"start", o.start_cold ? "cold" : "unknown"},
                             {"files", lines(story.run.files)},
                             {"findings", lines(indices(report.findings.size()), finding)},
                             {"counts", counts_json(story)},
                             {"facts", lines(report.facts)},
                             {"exercised", lines(report.exercised, exercised)}};
  if (!story.expected.name.empty()) {
    out.emplace_back("expectations", lines(indices(story.outcome.results.size()), expectation));
  }
  return text::Json::object(out, "\n");
}

}  // namespace rubric::report
