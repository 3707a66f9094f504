#include "conformance/check/report/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "codec/reflect/fault_text.h"
#include "conformance/check/report/chart.h"
#include "conformance/check/report/scene.h"
#include "conformance/check/report/words.h"

namespace rubric::report {
namespace {

using check::Finding;
using check::kNobody;
using check::Severity;

constexpr std::size_t kFramesBefore = 3;
constexpr std::size_t kFramesAfter = 2;
constexpr std::size_t kFactLines = 6;    // More are run together.
constexpr std::size_t kLinesOfRule = 3;  // Of a rule and severity, without --verbose.

class TextReport {
 public:
  TextReport(const Story& story, const TextOptions& options)
      : story_(story), options_(options), windows_(story.run, story.options, options.judge) {}

  std::string text() {
    about_the_run();
    std::vector<std::size_t> lines;  // Findings that get a line each.
    std::set<std::pair<std::size_t, std::string>> told;
    std::map<std::pair<std::size_t, Severity>, std::size_t> in_full_of;
    const auto& findings = story_.report.findings;
    for (std::size_t i = 0; i < findings.size(); ++i) {
      const bool failed = findings[i].severity == Severity::kFail && !is_expected(i);
      const std::size_t rule = reflect::requirement_index(findings[i].requirement);
      const bool first = failed && told.emplace(rule, findings[i].node).second;
      const bool wanted = first || options_.verbose;
      if (wanted && in_full_of[{rule, findings[i].severity}]++ < options_.findings_max) {
        in_full(i);
      } else {
        lines.push_back(i);
      }
    }
    in_lines(lines);
    expectations();
    sum();
    return std::move(out_);
  }

  std::string one(std::size_t i) {
    options_.verbose ? in_full(i) : in_line(i);
    return std::exchange(out_, {});
  }

 private:
  bool is_expected(std::size_t i) const { return story_.outcome.expected_by[i] != kUnexpected; }

  std::string_view style_of(Severity severity) const {
    switch (severity) {
      case Severity::kFail: return "1;31";
      case Severity::kWeak: return "33";
      case Severity::kInconclusive: return "35";
      case Severity::kStray: return "36";
      case Severity::kNote: return "2";
    }
    return "0";
  }

  void styled_line(std::string_view style, std::string_view head, std::string_view rest) {
    out_ += text::styled(options_, style, head, rest);
  }

  void about_the_run() {
    for (std::size_t f = 0; f < story_.run.files.size(); ++f) {
      const bool several = story_.run.files.size() > 1;
      const std::string name = text::harmless(story_.run.files[f]);
      out_ += several ? fmt::format("{}. {}\n", f + 1, name) : name + "\n";
    }
    const check::Options& o = story_.options;
    out_ += text::wrapped(
        text::kIndent,
        fmt::format("{}; profile {}, sniffer {}, start {}",
                    text::counted(story_.report.frames, "frame"), o.deployed ? "deployed" : "paper",
                    o.sniffer_complete ? "complete" : "unknown", o.start_cold ? "cold" : "unknown"),
        options_.width);
    std::string all;
    for (const std::string& fact : story_.report.facts) all += (all.empty() ? "" : "; ") + fact;
    if (story_.report.facts.size() > kFactLines) {
      out_ += text::wrapped(text::kIndent, all, options_.width);
    } else {
      for (const std::string& fact : story_.report.facts) {
        out_ += text::wrapped(text::kIndent, fact, options_.width);
      }
    }
    if (story_.report.frames == 0) {
      out_ += text::wrapped(text::kIndent, "No frames of this protocol: there is nothing to judge.",
                            options_.width);
    } else if (story_.report.exercised.empty() && story_.report.findings.empty()) {
      out_ +=
          text::wrapped(text::kIndent,
                        "No frame keeps or breaks a rule of RUBICON; 'rubric decode' shows what "
                        "they hold.",
                        options_.width);
    }
    if (!story_.run.has_time) {
      out_ +=
          text::wrapped(text::kIndent, "What has no time stamps is not judged by rules about time.",
                        options_.width);
    }
  }

  std::string times_text(const Finding& finding) const {
    if (finding.count < 2) return {};
    std::string out = fmt::format(", {} times", finding.count);
    if (finding.last.frame != 0) out += fmt::format(" up to frame {}", finding.last.frame);
    return out;
  }

  std::string heading(std::size_t i) const {
    const Finding& finding = story_.report.findings[i];
    return heading_text(story_.run, finding) + times_text(finding);
  }

  std::string head(std::size_t i) const {
    std::string name = text::in_capitals(severity_name(story_.report.findings[i].severity));
    if (is_expected(i)) name = "EXPECTED " + name;
    return options_.head.empty() ? name : options_.head + " " + name;
  }

  void in_full(std::size_t i) {
    const Finding& finding = story_.report.findings[i];
    out_ += '\n';
    styled_line(style_of(finding.severity), head(i), heading(i));
    out_ += text::wrapped(text::kIndent, finding.text, options_.width);
    const reflect::Requirement& rule = reflect::requirement(finding.requirement);
    if (finding.requirement != ReqId::kNone) {
      out_ += text::field("Rule:",
                          fmt::format("{} ({} {}; {})", rule.sentence, rule.level, rule.id,
                                      *rule.source == '\0' ? rule.clause : rule.source),
                          options_);
    }
    out_ += text::field("Allowed:", finding.expected, options_);
    if (is_expected(i)) {
      out_ += text::field(
          "Expected:", story_.expected.entries[story_.outcome.expected_by[i]].reason, options_);
    }
    hypotheses(finding);
    frames(finding);
    replay(finding);
  }

  void hypotheses(const Finding& finding) {
    if (finding.hypotheses.empty()) return;
    const bool one = finding.hypotheses.size() == 1;
    out_ += fmt::format(
        "{}{}\n", text::kIndent,
        one ? "What could explain it:" : "What could explain it, the one that got furthest first:");
    for (std::size_t h = 0; h < finding.hypotheses.size(); ++h) {
      const check::Hypothesis& hypothesis = finding.hypotheses[h];
      out_ += text::wrapped(fmt::format("{:>4}. ", h + 1), hypothesis.text, options_.width);
      const std::string_view miss = h == 0 ? "nearest miss:" : "missed:";
      if (!hypothesis.allowed.empty()) {
        out_ += text::wrapped("      allowed next: ", hypothesis.allowed, options_.width);
      }
      if (!hypothesis.miss.empty()) {
        out_ += text::wrapped(fmt::format("      {:<13} ", miss), hypothesis.miss, options_.width);
      }
    }
  }

  // Returns the frame at the place with some before and after it that concern the same node; for a
  // sink, only those about the same motes.
  std::vector<std::size_t> window(std::size_t at, std::uint16_t node) {
    std::vector<std::uint16_t> topic;
    if (at < story_.run.seen.size()) topic = scene_->topic(at);
    const auto chosen = [&](std::size_t i) {
      if (scene_->is_echo(i)) return false;
      if (!topic.empty()) {  // First, as it costs less in a run of many nodes.
        const std::vector<std::uint16_t> other = scene_->topic(i);
        const auto same =
            std::find_first_of(topic.begin(), topic.end(), other.begin(), other.end());
        if (same == topic.end()) return false;
      }
      return node == kNobody || scene_->concerns(i, node);
    };
    std::vector<std::size_t> rows;
    for (std::size_t i = at; i > 0 && rows.size() < kFramesBefore; --i) {
      if (chosen(i - 1)) rows.insert(rows.begin(), i - 1);
    }
    if (at >= story_.run.seen.size()) return rows;
    rows.push_back(at);
    const std::size_t full = rows.size() + kFramesAfter;
    for (std::size_t i = at + 1; i < story_.run.seen.size() && rows.size() < full; ++i) {
      if (chosen(i)) rows.push_back(i);
    }
    return rows;
  }

  void frames(const Finding& finding) {
    if (!scene_) scene_.emplace(story_.run, story_.options);
    const std::size_t all = story_.run.seen.size();
    const std::size_t at = finding.place.frame == 0 ? all : index_of(story_.run, finding.place);
    if (finding.place.frame != 0 && at == all) return;  // The run no longer holds it.
    std::uint16_t node = scene_->node_named(finding.node);
    if (node == kNobody && at < all) node = scene_->sender(at);
    const std::vector<std::size_t> rows = window(at, node);
    if (rows.empty()) return;
    out_ += fmt::format("{}Frames{}:\n", text::kIndent,
                        node == kNobody ? "" : " of " + text::harmless(scene_->name(node)));
    for (const std::size_t i : rows) {
      const check::Observation& seen = story_.run.seen[i];
      const check::Place& place = seen.place;
      std::string where = fmt::format("{} {:>5}", i == at ? '>' : ' ', place.frame);
      if (story_.run.files.size() > 1) where += fmt::format(" of {}", place.file + 1);
      where += fmt::format("  {} {}", seen.node.empty() ? "offset" : "line", place.offset_bytes);
      if (place.time_us >= 0) where += fmt::format(", {} s", text::seconds_text(place.time_us));
      out_ += fmt::format("{}{}, {}\n", text::kIndent, where, text::harmless(scene_->route(i)));
      constexpr std::string_view kDeep = "             ";
      const std::string message = text::harmless(scene_->message(i));
      // Shows the frame in question in full, the others on one line each.
      if (i == at || kDeep.size() + message.size() <= options_.width) {
        out_ += text::wrapped(kDeep, message, options_.width, kDeep.size() + 2);
      } else {
        const std::size_t room = options_.width - kDeep.size() - 3;
        const std::size_t end = std::min(message.rfind(' ', room), room);
        out_ += fmt::format("{}{}...\n", kDeep, message.substr(0, end));
      }
    }
    out_ += '\n' + chart(*scene_, rows, at, text::kIndent.size() + 2, options_.width);
  }

  void replay(const Finding& finding) {
    if (options_.command.empty()) return;
    std::string ranges;
    if (options_.judge) {
      for (const FrameRange& range : windows_.around(finding)) {
        ranges += " --frames " + range_text(range, story_.run.files.size());
      }
    }
    // A command is meant to be copied, so it is not broken.
    out_ += fmt::format("\n{}Again:    {}{}{}\n", text::kIndent, options_.command, options_.files,
                        ranges);
  }

  // Prints the rest: by severity, then by rule, a few of each.
  void in_lines(const std::vector<std::size_t>& which) {
    using Key =
        std::tuple<int, bool, std::size_t>;  // The last is the rule's place in the catalogue.
    std::map<Key, std::vector<std::size_t>> groups;
    for (const std::size_t i : which) {
      const Finding& finding = story_.report.findings[i];
      groups[{-static_cast<int>(finding.severity), is_expected(i),
              reflect::requirement_index(finding.requirement)}]
          .push_back(i);
    }
    if (!groups.empty()) out_ += '\n';
    for (const auto& [key, group] : groups) {
      for (std::size_t n = 0; n < group.size(); ++n) {
        const Finding& finding = story_.report.findings[group[n]];
        if (n >= kLinesOfRule && group.size() > kLinesOfRule + 1) {
          const bool listed = !options_.verbose && group.size() <= options_.findings_max;
          out_ += fmt::format("{}and {} more of {} ({})\n", text::kIndent, group.size() - n,
                              rule_text(finding.requirement),
                              listed ? "--verbose lists them" : "--max-findings N shows N in full");
          break;
        }
        in_line(group[n]);
      }
    }
  }

  void in_line(std::size_t i) {
    const Finding& finding = story_.report.findings[i];
    std::string rest =
        fmt::format("{}: {}", heading(i), options_.text.empty() ? finding.text : options_.text);
    if (is_expected(i)) {
      rest += fmt::format(" Expected: {}",
                          story_.expected.entries[story_.outcome.expected_by[i]].reason);
    }
    styled_line(style_of(finding.severity), head(i), rest);
  }

  void expectations() {
    for (std::size_t e = 0; e < story_.outcome.results.size(); ++e) {
      const ExpectationResult& result = story_.outcome.results[e];
      const KnownFailure& one = story_.expected.entries[e];
      const std::string place = fmt::format("{}:{}", story_.expected.name, one.line);
      if (result.state == ExpectationState::kStale) {
        out_ += '\n';
        styled_line("1;31", "STALE",
                    fmt::format("{}: {} does not fail with \"{}\" any more. If that is meant, "
                                "delete the expectation.",
                                place, one.requirement, one.message));
      } else if (result.state == ExpectationState::kOtherMessage) {
        const Finding& finding = story_.report.findings[result.findings.front()];
        out_ += '\n';
        styled_line("1;31", "OTHER MESSAGE",
                    fmt::format("{}: {} was expected to say \"{}\", but {} says: {}", place,
                                one.requirement, one.message, place_text(story_.run, finding.place),
                                finding.text));
      }
    }
  }

  void sum() {
    out_ += '\n';
    styled_line(story_.outcome.exit_code() == 0 ? "1;32" : "1;31",
                "Verdict:", text_verdict(story_));
  }

  const Story& story_;
  const TextOptions& options_;
  Windows windows_;
  std::optional<Scene> scene_;  // Costs a pass, so only where there is something to show.
  std::string out_;
};

}  // namespace

std::string text_report(const Story& story, const TextOptions& options) {
  return TextReport(story, options).text();
}

std::string text_verdict(const Story& story) {
  std::map<Severity, std::uint64_t> counts;
  std::uint64_t expected = 0;
  const Outcome& outcome = story.outcome;
  for (std::size_t i = 0; i < story.report.findings.size(); ++i) {
    const bool known = outcome.expected_by[i] != kUnexpected;
    ++(known ? expected : counts[story.report.findings[i].severity]);
  }
  std::string text = text::counted(counts[Severity::kFail], "failure");
  if (!story.expected.entries.empty()) {
    text += fmt::format(", {} expected, {} not true", text::counted(expected, "known failure"),
                        text::counted(outcome.broken_expectations, "expectation"));
  }
  for (const Severity severity :
       {Severity::kWeak, Severity::kStray, Severity::kInconclusive, Severity::kNote}) {
    if (counts[severity] == 0) continue;
    const bool note = severity == Severity::kNote;
    text += ", " + (note ? text::counted(counts[severity], "note")
                         : fmt::format("{} {}", counts[severity], severity_name(severity)));
  }
  text += fmt::format("; {} judged, {} exercised", text::counted(story.report.frames, "frame"),
                      text::counted(story.report.exercised.size(), "rule"));
  std::string verdict(verdict_name(outcome.verdict));
  if (outcome.verdict == check::Verdict::kFail && outcome.as_expected()) {
    verdict += " as expected";
  } else if (outcome.nothing_judged) {
    verdict += ", nothing could be judged";
  }
  if (outcome.input_missing) verdict += ", but input is damaged or missing";
  return fmt::format("{}: {}.", verdict, text);
}

std::string text_finding(const Story& story, std::size_t index, const TextOptions& options) {
  return TextReport(story, options).one(index);
}

std::vector<std::string> text_findings(const Story& story, const std::vector<std::size_t>& indices,
                                       const TextOptions& options) {
  TextReport report(story, options);
  std::vector<std::string> out;
  for (const std::size_t i : indices) out.push_back(report.one(i));
  return out;
}

}  // namespace rubric::report
