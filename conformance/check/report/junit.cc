#include "conformance/check/report/junit.h"

#include <fmt/format.h>

#include <map>

#include "codec/reflect/fault_text.h"
#include "conformance/check/report/words.h"
#include "conformance/report/junit.h"

namespace rubric::report {
namespace {

using check::Finding;
using check::Severity;

/// The findings about one rule.
struct RuleFindings {
  std::uint64_t kept = 0;
  std::vector<std::size_t> failures;
  std::vector<std::size_t> undecided;
  std::vector<std::size_t> others;  ///< Known failures, weak ones, strays and notes.
};

class Junit {
 public:
  explicit Junit(const Story& story) : story_(story) {}

  std::string xml() {
    JunitSuite suite{.name = "rubric check"};
    for (const std::string& file : story_.run.files) suite.name += " " + file;
    suite.properties = {{"profile", profile()},
                        {"verdict", std::string(verdict_name(story_.outcome.verdict))},
                        {"frames", std::to_string(story_.report.frames)}};
    for (const auto& [id, one] : by_rule()) suite.cases.push_back(rule(id, one));
    if (story_.outcome.input_missing) {
      suite.cases.push_back({.class_name = "rubric.check.input",
                             .name = "the input is whole",
                             .outcome = JunitCase::Outcome::kError,
                             .type = "input",
                             .message = "Input is damaged or missing; the rest was judged."});
    }
    for (std::size_t e = 0; e < story_.outcome.results.size(); ++e) {
      if (story_.outcome.results[e].state != ExpectationState::kNotApplicable)
        suite.cases.push_back(expectation(e));
    }
    for (const std::string& fact : story_.report.facts) suite.output += fact + "\n";
    return junit_document({suite});
  }

 private:
  const char* profile() const { return story_.options.deployed ? "deployed" : "paper"; }

  std::map<ReqId, RuleFindings, reflect::CatalogueOrder> by_rule() const {
    std::map<ReqId, RuleFindings, reflect::CatalogueOrder> out;
    for (const auto& [id, count] : story_.report.exercised) out[id].kept = count;
    for (std::size_t i = 0; i < story_.report.findings.size(); ++i) {
      const Finding& finding = story_.report.findings[i];
      RuleFindings& one = out[finding.requirement];
      const bool known = story_.outcome.expected_by[i] != kUnexpected;
      if (finding.severity == Severity::kFail && !known) {
        one.failures.push_back(i);
      } else if (finding.severity == Severity::kInconclusive) {
        one.undecided.push_back(i);
      } else {
        one.others.push_back(i);
      }
    }
    return out;
  }

  std::string line(std::size_t i) const {
    const Finding& finding = story_.report.findings[i];
    std::string out = fmt::format("{}{}: {}", finding.node.empty() ? "" : finding.node + ", ",
                                  place_text(story_.run, finding.place), finding.text);
    if (finding.count > 1) out += fmt::format(" ({} times)", finding.count);
    return out;
  }

  std::string in_full(std::size_t i) const {
    const Finding& finding = story_.report.findings[i];
    const reflect::Requirement& rule = reflect::requirement(finding.requirement);
    std::string out = line(i) + "\n";
    if (*rule.sentence != '\0') out += fmt::format("Rule: {} ({})\n", rule.sentence, rule.level);
    if (!finding.expected.empty()) out += "Allowed: " + finding.expected + "\n";
    for (const check::Hypothesis& h : finding.hypotheses) {
      out += fmt::format("- {} Allowed next: {} Missed: {}\n", h.text, h.allowed, h.miss);
    }
    return out;
  }

  std::string message(const std::vector<std::size_t>& which) const {
    std::string out = line(which.front());
    if (which.size() > 1) out += fmt::format(" (and {} more)", which.size() - 1);
    return out;
  }

  JunitCase rule(ReqId id, const RuleFindings& one) const {
    const reflect::Requirement& rule = reflect::requirement(id);
    JunitCase out;
    out.class_name = std::string("rubric.check.") + profile();
    out.name = id == ReqId::kNone ? "(no rule)" : rule.id;
    if (!one.failures.empty()) {
      out.outcome = JunitCase::Outcome::kFailure;
      out.type = rule.level;
      out.message = message(one.failures);
      for (const std::size_t i : one.failures) out.body += in_full(i);
    } else if (!one.undecided.empty()) {
      out.outcome = JunitCase::Outcome::kSkipped;
      out.message = message(one.undecided);
    }
    out.output =
        one.kept == 0 ? "never seen kept\n" : "kept " + text::counted(one.kept, "time") + "\n";
    for (const std::size_t i : one.undecided) out.output += "inconclusive: " + line(i) + "\n";
    for (const std::size_t i : one.others) {
      const std::size_t by = story_.outcome.expected_by[i];
      out.output +=
          fmt::format("{}: {}{}\n", severity_name(story_.report.findings[i].severity), line(i),
                      by == kUnexpected ? "" : " Known: " + story_.expected.entries[by].reason);
    }
    return out;
  }

  JunitCase expectation(std::size_t e) const {
    const ExpectationResult& result = story_.outcome.results[e];
    const KnownFailure& one = story_.expected.entries[e];
    JunitCase out{.class_name = "rubric.check.expectations"};
    out.name = fmt::format("{}:{} {} {}", story_.expected.name, one.line, one.requirement, e + 1);
    if (result.state == ExpectationState::kMatched) return out;
    const bool stale = result.state == ExpectationState::kStale;
    out.outcome = JunitCase::Outcome::kFailure;
    out.type = state_name(result.state);
    out.message =
        stale ? fmt::format("{} does not fail with \"{}\" any more", one.requirement, one.message)
              : fmt::format("expected \"{}\", but it says: {}", one.message,
                            message(result.findings));
    return out;
  }

  const Story& story_;
};

}  // namespace

std::string junit_report(const Story& story) { return Junit(story).xml(); }

}  // namespace rubric::report
