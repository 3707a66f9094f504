#include "conformance/oracle/report/junit.h"

#include <fmt/format.h>

#include <map>

#include "codec/reflect/fault_text.h"
#include "conformance/oracle/report/words.h"

namespace rubric::report {
namespace {

using oracle::Finding;
using oracle::Severity;

/// What is said of one rule.
struct Case {
  std::uint64_t kept = 0;
  std::vector<std::size_t> failures;
  std::vector<std::size_t> undecided;
  std::vector<std::size_t> others;  ///< Known failures, weak ones, strays and notes.
};

class Junit {
 public:
  explicit Junit(const Story& story) : story_(story) {
    for (const auto& [id, count] : story.report.exercised) cases_[id].kept = count;
    for (std::size_t i = 0; i < story.report.findings.size(); ++i) {
      const Finding& finding = story.report.findings[i];
      Case& one = cases_[finding.requirement];
      const bool known = story.outcome.expected_by[i] != kUnexpected;
      if (finding.severity == Severity::kFail && !known) {
        one.failures.push_back(i);
      } else if (finding.severity == Severity::kInconclusive) {
        one.undecided.push_back(i);
      } else {
        one.others.push_back(i);
      }
    }
  }

  std::string xml() {
    for (const auto& [id, one] : cases_) rule(id, one);
    for (std::size_t e = 0; e < story_.outcome.results.size(); ++e) expectation(e);
    std::string name = "rubric check";
    for (const std::string& file : story_.run.files) name += " " + file;
    std::string facts;
    for (const std::string& fact : story_.report.facts) facts += fact + "\n";
    std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
    out += fmt::format(
        "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" "
        "time=\"0\">\n",
        xml_text(name), tests_, failures_, skipped_);
    out += fmt::format(
        "<properties>\n<property name=\"profile\" value=\"{}\"/>\n"
        "<property name=\"verdict\" value=\"{}\"/>\n"
        "<property name=\"frames\" value=\"{}\"/>\n</properties>\n",
        story_.options.deployed ? "deployed" : "paper", verdict_name(story_.outcome.verdict),
        story_.report.frames);
    out += body_;
    if (!facts.empty()) out += "<system-out>" + xml_text(facts) + "</system-out>\n";
    return out + "</testsuite>\n</testsuites>\n";
  }

 private:
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
    for (const oracle::Hypothesis& h : finding.hypotheses) {
      out += fmt::format("- {} Allowed next: {} Missed: {}\n", h.text, h.allowed, h.miss);
    }
    return out;
  }

  std::string message(const std::vector<std::size_t>& which) const {
    std::string out = line(which.front());
    if (which.size() > 1) out += fmt::format(" (and {} more)", which.size() - 1);
    return xml_text(out);
  }

  void rule(ReqId id, const Case& one) {
    const reflect::Requirement& rule = reflect::requirement(id);
    ++tests_;
    body_ += fmt::format("<testcase classname=\"rubric.check.{}\" name=\"{}\" time=\"0\">\n",
                         story_.options.deployed ? "deployed" : "paper",
                         xml_text(id == ReqId::kNone ? "(no rule)" : rule.id));
    if (!one.failures.empty()) {
      ++failures_;
      std::string text;
      for (const std::size_t i : one.failures) text += in_full(i);
      body_ += fmt::format("<failure type=\"{}\" message=\"{}\">{}</failure>\n",
                           xml_text(rule.level), message(one.failures), xml_text(text));
    } else if (!one.undecided.empty()) {
      ++skipped_;
      body_ += fmt::format("<skipped message=\"{}\"/>\n", message(one.undecided));
    }
    system_out(one);
    body_ += "</testcase>\n";
  }

  void system_out(const Case& one) {
    std::string text = fmt::format("{}\n", one.kept == 0 ? "never seen kept"
                                                         : "kept " + counted(one.kept, "time"));
    for (const std::size_t i : one.undecided) text += "inconclusive: " + line(i) + "\n";
    for (const std::size_t i : one.others) {
      const std::size_t by = story_.outcome.expected_by[i];
      text += fmt::format("{}: {}{}\n", severity_name(story_.report.findings[i].severity), line(i),
                          by == kUnexpected
                              ? ""
                              : " Known: " + story_.expected.expectations[by].reason);
    }
    body_ += "<system-out>" + xml_text(text) + "</system-out>\n";
  }

  void expectation(std::size_t e) {
    const ExpectationResult& result = story_.outcome.results[e];
    if (result.came == Came::kNotAsked) return;
    const Expectation& one = story_.expected.expectations[e];
    const char* const id = reflect::requirement(one.requirement).id;
    ++tests_;
    body_ += fmt::format(
        "<testcase classname=\"rubric.check.expectations\" name=\"{}:{} {} {}\" time=\"0\">\n",
        xml_text(story_.expected.name), one.line, id, e + 1);
    if (result.came == Came::kStale) {
      ++failures_;
      body_ += fmt::format("<failure type=\"stale\" message=\"{} does not fail with &quot;{}&quot; "
                           "any more\"/>\n", id, xml_text(one.message));
    } else if (result.came == Came::kOtherMessage) {
      ++failures_;
      body_ += fmt::format("<failure type=\"other_message\" message=\"expected &quot;{}&quot;, but "
                           "it says: {}\"/>\n", xml_text(one.message), message(result.findings));
    }
    body_ += "</testcase>\n";
  }

  const Story& story_;
  std::map<ReqId, Case, reflect::CatalogueOrder> cases_;
  std::string body_;
  std::uint64_t tests_ = 0;
  std::uint64_t failures_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace

std::string junit_report(const Story& story) { return Junit(story).xml(); }

}  // namespace rubric::report
