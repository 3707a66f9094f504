#include "conformance/test/report/text/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "codec/reflect/fault_text.h"
#include "codec/text/text.h"
#include "conformance/machine/ticks.h"
#include "conformance/report/sequence.h"
#include "conformance/test/report/chart.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/test/report/text/style.h"
#include "conformance/test/report/words.h"
#include "conformance/test/suite/result.h"
#include "conformance/trace/print.h"
#include "conformance/trace/trace.h"
#include "conformance/trace/value_text.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;
using runner::Failure;
using text::counted;
using text::wrapped;
using trace::Line;

// Shows the events around a line that was not kept: the log, and a chart of it.

constexpr std::size_t kBefore = 6;
constexpr std::size_t kAfter = 3;

// A line of the log, or nothing at the place of a missing one.
struct Row {
  std::optional<Line> line;
  bool marked = false;
};

runner::Ticks time_of(const Line& line) { return static_cast<runner::Ticks>(line.time.from); }

std::vector<Row> rows_around(const CaseRun& one, const runner::Failure& failure) {
  const trace::Case log = one.result.log.read();
  const std::vector<const Line*> lines = log.lines();
  std::size_t at = 0;  // After its cause.
  bool breaks = false;
  for (std::size_t i = 0; i < lines.size() && !breaks; ++i) {
    if (time_of(*lines[i]) > (failure.forbidden ? failure.time : failure.to)) break;
    at = i + 1;
    breaks = is_broken_by(failure, *lines[i]);
  }
  std::vector<Row> rows;
  for (std::size_t i = at - std::min(at, kBefore); i < at; ++i) {
    rows.push_back({*lines[i], (breaks || failure.crash) && i + 1 == at});
  }
  if (!breaks && !failure.expected.empty()) rows.push_back({std::nullopt, true});
  for (std::size_t i = at; i < std::min(at + kAfter, lines.size()); ++i) {
    rows.push_back({*lines[i], false});
  }
  return rows;
}

// Returns the message with the last names of paths, where these are enough: "led" for
// "mote_desc.led".
trace::Message with_short_paths(trace::Message message) {
  const auto tail = [](const trace::FieldValue& field) {
    return field.path.substr(field.path.rfind('.') + 1);
  };
  std::map<std::string, int> counts;
  for (const trace::FieldValue& field : message.fields) ++counts[tail(field)];
  for (trace::FieldValue& field : message.fields) {
    if (counts[tail(field)] == 1) field.path = tail(field);
  }
  return message;
}

std::string window_text(const runner::Failure& failure) {
  return failure.from == failure.to ? fmt::format("@{}", failure.from)
                                    : fmt::format("@{}..{}", failure.from, failure.to);
}

// Returns lines of the log before and after the failure; those that break a rule or were the last
// before a death, or the place of a missing one, are marked with ">". Each line begins with
// `indent` blanks.
std::string log_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                       std::size_t width) {
  std::string out;
  for (const Row& row : rows_around(one, failure)) {
    const std::string head = std::string(indent, ' ') + (row.marked ? "> " : "  ");
    if (!row.line) {
      const std::optional<Line> asked = asked_line(failure);
      out += text::wrapped(head + fmt::format("{:<9} ", window_text(failure)),
                           failure.forbidden || !asked
                               ? "here"
                               : fmt::format("no {} that is as the line says{}",
                                             asked->message.name, elsewhere_text(failure)),
                           width);
      continue;
    }
    Line line = *row.line;
    line.bytes.reset();
    line.requirements.clear();
    const std::string am = line.am ? fmt::format("am={}->{} ", trace::value_text(line.am->source),
                                                 trace::value_text(line.am->dest))
                                   : std::string();
    out += text::wrapped(head + fmt::format("{:<9} ", fmt::format("@{}", line.time.from)),
                         fmt::format("{} {} {} {}{}", line.node, trace::op_text(line.op), line.link,
                                     am, trace::print(with_short_paths(line.message))),
                         width);
  }
  return out;
}

// Returns the same as a sequence chart with "<<<" at the fault.
std::string chart_around(const CaseRun& one, const runner::Failure& failure, std::size_t indent,
                         std::size_t width) {
  const Stage stage(one);
  report::Sequence sequence{.columns = stage.names(), .number_title = "tick"};
  for (const Row& row : rows_around(one, failure)) {
    report::SequenceRow drawn;
    if (row.line) {
      drawn = stage.row(*row.line);
      drawn.number = std::to_string(row.line->time.from);
    } else {
      const std::optional<Line> asked = asked_line(failure);
      if (asked) drawn.from = stage.column(asked->node);
      drawn.number = std::to_string(failure.to);
      drawn.label = asked ? "no " + asked->message.name + elsewhere_text(failure) : "here";
    }
    drawn.marked = row.marked;
    sequence.rows.push_back(std::move(drawn));
  }
  return report::sequence_text(sequence, indent, width);
}

constexpr std::size_t kNameColumns = 40;
constexpr std::size_t kAlso = 4;  // Further lines of a case that were not kept.

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

// Returns "FAIL", "EXPECTED FAIL", "UNEXPECTED PASS".
std::string head_of(const CaseRun& one) {
  const std::string verdict = in_capitals(runner::verdict_text(one.result.verdict));
  if (one.expectation == Expectation::kAsExpected) return "EXPECTED " + verdict;
  if (one.expectation == Expectation::kUnexpectedPass) return "UNEXPECTED " + verdict;
  return verdict;
}

std::string ms_text(runner::Ticks ticks) {
  return fmt::format("{:.1f} ms", static_cast<double>(machine::us_of(ticks)) / 1000);
}

std::string when_text(const Failure& failure) {
  if (failure.from == failure.to) {
    return fmt::format("at tick {} ({})", failure.from, ms_text(failure.from));
  }
  return fmt::format("from tick {} to {} ({} to {})", failure.from, failure.to,
                     ms_text(failure.from), ms_text(failure.to));
}

std::string rule_text(const Failure& failure, const TextOptions& options) {
  std::string out;
  for (const std::string& name : failure.requirements) {
    const reflect::Requirement& rule = reflect::requirement(trace::requirement_id(name));
    if (*rule.id == '\0') continue;
    out += field(out.empty() ? "Rule:" : "",
                 fmt::format("{} ({} {}; {})", rule.sentence, rule.level, rule.id,
                             *rule.source == '\0' ? rule.clause : rule.source),
                 options);
  }
  return out;
}

std::string failure_text(const CaseRun& one, const Failure& failure, const TextOptions& options) {
  std::string out = rule_text(failure, options);
  if (failure.requirements.empty() && !failure.expected.empty()) {
    out += field("Rule:", "none; the set-up of this case, which cannot go on without it.", options);
  }
  if (!failure.expected.empty()) {
    out += field(failure.forbidden ? "Forbids:" : "Asks for:", failure.expected, options);
    out += field("",
                 fmt::format("line {} of {}, {}", failure.place.line, one.file, when_text(failure)),
                 options);
  }
  out += field(failure.crash ? "Broke:" : "But:", failure.text, options);
  if (failure.crash) {
    out += field("", fmt::format("after line {} of {}", failure.place.line, one.file), options);
  }
  out += field("Suspects:", joined(failure.suspected), options);
  if (!failure.cause.empty()) {
    out += field("Cause:", failure.cause + ", perhaps, which other cases show broken.", options);
  }
  return out;
}

// Builds the text of story_text().
class Story {
 public:
  Story(const SuiteRun& run, const ImplementationRun& implementation, const TextOptions& options)
      : run_(run), implementation_(implementation), options_(options) {}

  std::string text() {
    for (const CaseRun& one : implementation_.cases) {
      if (one.result.verdict == CaseVerdict::kError || one.result.verdict == CaseVerdict::kFail ||
          one.expectation != Expectation::kNone) {
        tell(one);
      } else if (!one.result.failures.empty() && !options_.quiet) {  // Of SHOULD rules alone.
        if (options_.verbose)
          in_full(one);
        else
          weak_.push_back(&one);
      }
    }
    in_lines(brief_);
    in_lines(weak_);
    by_reason(CaseVerdict::kInconclusive);
    by_reason(CaseVerdict::kSkip);
    return std::move(out_);
  }

 private:
  // Returns a key that is equal for similar cases: the rules that they break, or what broke.
  static std::string kind_of(const CaseRun& one) {
    const bool crashed = !one.result.failures.empty() && one.result.failures.front().crash;
    if (one.result.verdict == CaseVerdict::kError || crashed) return what_broke(one);
    if (one.result.failures.empty()) return one.name;
    return joined(one.result.failures.front().requirements);
  }

  void tell(const CaseRun& one) {
    const bool known = one.expectation == Expectation::kAsExpected;
    const bool first = !known && told_.insert(kind_of(one)).second;
    if (known && options_.quiet) return;
    if (first || options_.verbose)
      in_full(one);
    else
      brief_.push_back(&one);
  }

  void in_full(const CaseRun& one) {
    out_ += '\n';
    out_ += styled(options_, style_of(one.result.verdict, one.unexpected()), head_of(one),
                   case_name(one));
    if (!one.comment.empty()) out_ += wrapped(kIndent, one.comment, options_.width);
    const bool known = one.expectation == Expectation::kAsExpected;
    out_ += field(known ? "Expected:" : "Known:", one.expected_reason, options_);
    if (one.result.verdict == CaseVerdict::kError) {
      const std::uint32_t line =
          one.result.failures.empty() ? 0 : one.result.failures.front().place.line;
      out_ += field("Broke:", one.result.reason, options_);
      if (line > 0) out_ += field("", fmt::format("at line {} of {}", line, one.file), options_);
    } else {
      failures(one);
    }
    surroundings(one);
    out_ += error_text(one.stderr_text, options_);
    out_ += fmt::format("{}Again:    {}\n", kIndent, replay_command(run_, implementation_, one));
  }

  void failures(const CaseRun& one) {
    const std::vector<Failure>& all = one.result.failures;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Failure& failure = all[i];
      if (i == 0 || options_.verbose) {
        out_ += failure_text(one, failure, options_);
      } else if (i <= kAlso) {
        const std::string rules = joined(failure.rules());
        out_ += field(failure.implied ? "Then:" : "Also:",
                      fmt::format("line {}{}: {}", failure.place.line,
                                  rules.empty() ? "" : " [" + rules + "]", failure.text),
                      options_);
      }
    }
    if (all.size() > kAlso + 1 && !options_.verbose) {
      out_ += field("", fmt::format("and {} lines more", all.size() - kAlso - 1), options_);
    }
  }

  void surroundings(const CaseRun& one) {
    if (one.result.failures.empty() || one.result.log.empty()) return;
    const Failure& failure = one.result.failures.front();
    out_ += fmt::format("{}Log, in ticks of 1/{} s:\n", kIndent, machine::kTicksPerSecond);
    out_ += log_around(one, failure, 2 * kIndent.size(), options_.width);
    if (failure.expected.empty() && !failure.crash) return;
    out_ += '\n' + chart_around(one, failure, 2 * kIndent.size(), options_.width);
  }

  void in_lines(const std::vector<const CaseRun*>& cases) {
    if (!cases.empty()) out_ += '\n';
    for (const CaseRun* one : cases) {
      std::string rest = fmt::format("{}: {}", case_name(*one), headline(*one));
      if (one->expectation == Expectation::kAsExpected) rest += ". " + one->expected_reason;
      out_ +=
          styled(options_, style_of(one->result.verdict, one->unexpected()), head_of(*one), rest);
    }
  }

  void by_reason(CaseVerdict verdict) {
    std::map<std::string, std::vector<std::string>> reasons;
    for (const CaseRun& one : implementation_.cases) {
      if (one.result.verdict != verdict) continue;
      const std::string listed = one.expected_reason.empty() ? "" : ", as listed: ";
      const std::string reason =
          options_.verbose ? one.result.reason : what_was_missing(one.result.reason);
      reasons[reason + listed + one.expected_reason].push_back(case_name(one));
    }
    if (!reasons.empty()) out_ += '\n';
    for (const auto& [reason, cases] : reasons) {
      const std::string names = options_.verbose || cases.size() <= 3
                                    ? fmt::format(" ({})", joined(cases))
                                    : std::string();
      out_ += styled(options_, style_of(verdict, false), in_capitals(runner::verdict_text(verdict)),
                     fmt::format("{}: {}{}", counted(cases.size(), "case"), reason, names));
    }
  }

  const SuiteRun& run_;
  const ImplementationRun& implementation_;
  const TextOptions& options_;
  std::set<std::string> told_;
  std::vector<const CaseRun*> brief_;
  std::vector<const CaseRun*> weak_;
  std::string out_;
};

}  // namespace

std::string case_text(const CaseRun& one, const TextOptions& options) {
  if (options.quiet && !one.unexpected()) return {};
  // One sentence for all of them will do.
  if (!options.verbose && is_beyond_reach(one) && one.result.failures.empty()) return {};
  std::string verdict(runner::verdict_text(one.result.verdict));
  const std::string_view style = style_of(one.result.verdict, one.unexpected());
  std::string rest;
  if (one.expectation == Expectation::kAsExpected) {
    rest = "as expected";
  } else if (one.expectation == Expectation::kUnexpectedPass) {
    rest = "was expected to fail";
  } else if (one.result.verdict != CaseVerdict::kPass) {
    rest = text::harmless(headline(one));
  }
  const std::string name = text::harmless(case_name(one));
  std::string out = fmt::format("{:<12} {}", verdict, name);
  if (!rest.empty()) {
    out = fmt::format("{:<12} {:<{}} {}", verdict, name, kNameColumns, rest);
    if (options.cuts && out.size() > options.width) out = out.substr(0, options.width - 3) + "...";
  }
  return painted(options, style, verdict) + out.substr(verdict.size()) + '\n';
}

std::string story_text(const SuiteRun& run, const ImplementationRun& implementation,
                       const TextOptions& options) {
  return Story(run, implementation, options).text();
}

}  // namespace rubric::suite
