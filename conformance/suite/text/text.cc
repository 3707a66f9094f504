#include "conformance/suite/text/text.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "codec/reflect/fault_text.h"
#include "conformance/report/text.h"
#include "conformance/suite/report/words.h"
#include "conformance/suite/text/scene.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {
namespace {

using report::counted;
using report::wrapped;
using runner::CaseVerdict;
using runner::Failure;

constexpr std::string_view kIndent = "  ";
constexpr std::size_t kNameColumns = 40;
constexpr std::size_t kAlso = 4;         // Further lines of a case that were not kept.
constexpr std::size_t kErrorLines = 12;  // Of what an implementation wrote to its standard error.

std::string painted(const TextOptions& options, std::string_view style, std::string_view text) {
  return options.color ? fmt::format("\033[{}m{}\033[0m", style, text) : std::string(text);
}

std::string_view style_of(CaseVerdict verdict, bool unexpected) {
  switch (verdict) {
    case CaseVerdict::kPass: return unexpected ? "1;31" : "32";
    case CaseVerdict::kWeak: return "33";
    case CaseVerdict::kInconclusive: return "35";
    case CaseVerdict::kFail: return unexpected ? "1;31" : "33";
    case CaseVerdict::kError: return "1;31";
    case CaseVerdict::kSkip: return "2";
  }
  return "0";
}

std::string in_capitals(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c); });
  return out;
}

// "FAIL", "EXPECTED FAIL", "UNEXPECTED PASS".
std::string head_of(const CaseRun& one) {
  const std::string verdict = in_capitals(runner::verdict_text(one.result.verdict));
  if (one.expectation == Expectation::kAsExpected) return "EXPECTED " + verdict;
  if (one.expectation == Expectation::kUnexpectedPass) return "UNEXPECTED " + verdict;
  return verdict;
}

// A coloured first word, and the rest broken into lines.
std::string styled(const TextOptions& options, std::string_view style, const std::string& head,
                   const std::string& rest) {
  const std::string lines = wrapped("", head + " " + rest, options.width, kIndent.size());
  return painted(options, style, head) + lines.substr(head.size());
}

std::string field(std::string_view name, std::string_view text, const TextOptions& options) {
  if (text.empty()) return {};
  return wrapped(fmt::format("{}{:<9} ", kIndent, name), text, options.width);
}

std::string ms_text(runner::Ticks ticks) {
  return fmt::format("{:.1f} ms", static_cast<double>(ticks) * 1000 / 1024);
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
  if (!failure.expected.empty()) {
    out += field(failure.forbidden ? "Forbids:" : "Asks for:", failure.expected, options);
    out += field("", fmt::format("line {} of {}, {}", failure.place.line, one.file,
                                 when_text(failure)), options);
  }
  out += field("But:", failure.text, options);
  return out;
}

// Its last lines, each behind a bar.
std::string error_text(const std::string& text, const TextOptions& options) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  const std::size_t all = lines.size();
  if (all == 0) return {};
  const std::size_t first = options.verbose || all <= kErrorLines ? 0 : all - kErrorLines;
  std::string out = fmt::format("{}Its standard error{}:\n", kIndent,
                                first > 0 ? fmt::format(", last {} of {} lines", kErrorLines, all)
                                          : std::string());
  for (std::size_t i = first; i < all; ++i) {
    std::string shown;  // A terminal must not be told what to do.
    for (const char c : lines[i]) shown += c == '\t' || (c >= ' ' && c != 127) || c < 0 ? c : '?';
    out += fmt::format("{}  | {}\n", kIndent, shown);
  }
  return out;
}

// A case as an implementation that `story_text` tells of.
class Story {
 public:
  Story(const SuiteRun& run, const ImplementationRun& implementation, const TextOptions& options)
      : run_(run), implementation_(implementation), options_(options) {}

  std::string text() {
    for (const CaseRun& one : implementation_.cases) {
      if (one.result.verdict == CaseVerdict::kError || one.result.verdict == CaseVerdict::kFail ||
          one.expectation != Expectation::kNone) {
        tell(one);
      } else if (one.result.verdict == CaseVerdict::kWeak && !options_.quiet) {
        if (options_.verbose) in_full(one); else weak_.push_back(&one);
      }
    }
    in_lines(brief_);
    in_lines(weak_);
    by_reason(CaseVerdict::kInconclusive);
    by_reason(CaseVerdict::kSkip);
    return std::move(out_);
  }

 private:
  // What makes a second case like a first one: the rules that it breaks, or what broke.
  static std::string kind_of(const CaseRun& one) {
    if (one.result.verdict == CaseVerdict::kError) return one.result.reason;
    if (one.result.failures.empty()) return one.name;
    return fmt::format("{}", fmt::join(one.result.failures.front().requirements, " "));
  }

  void tell(const CaseRun& one) {
    const bool known = one.expectation == Expectation::kAsExpected;
    const bool first = !known && told_.insert(kind_of(one)).second;
    if (known && options_.quiet) return;
    if (first || options_.verbose) in_full(one); else brief_.push_back(&one);
  }

  void in_full(const CaseRun& one) {
    out_ += '\n';
    out_ += styled(options_, style_of(one.result.verdict, one.unexpected()), head_of(one),
                   case_name(one));
    out_ += wrapped(kIndent, one.comment, options_.width);
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
        out_ += field("Also:", fmt::format("line {} [{}]: {}", failure.place.line,
                                           fmt::join(failure.requirements, " "), failure.text),
                      options_);
      }
    }
    if (all.size() > kAlso + 1 && !options_.verbose) {
      out_ += field("", fmt::format("and {} lines more", all.size() - kAlso - 1), options_);
    }
  }

  void surroundings(const CaseRun& one) {
    if (one.result.failures.empty() || one.result.log.lines().empty()) return;
    const Failure& failure = one.result.failures.front();
    out_ += fmt::format("{}Log, in ticks of 1/1024 s:\n", kIndent);
    out_ += log_around(one, failure, 2 * kIndent.size(), options_.width);
    if (failure.expected.empty()) return;
    out_ += '\n' + chart_around(one, failure, 2 * kIndent.size(), options_.width);
  }

  void in_lines(const std::vector<const CaseRun*>& cases) {
    if (!cases.empty()) out_ += '\n';
    for (const CaseRun* one : cases) {
      std::string rest = fmt::format("{}: {}", case_name(*one), headline(*one));
      if (one->expectation == Expectation::kAsExpected) rest += ". " + one->expected_reason;
      out_ += styled(options_, style_of(one->result.verdict, one->unexpected()), head_of(*one),
                     rest);
    }
  }

  void by_reason(CaseVerdict verdict) {
    std::map<std::string, std::vector<std::string>> reasons;
    for (const CaseRun& one : implementation_.cases) {
      if (one.result.verdict == verdict) reasons[one.result.reason].push_back(case_name(one));
    }
    if (!reasons.empty()) out_ += '\n';
    for (const auto& [reason, cases] : reasons) {
      const std::string names = options_.verbose || cases.size() <= 3
                                    ? fmt::format(" ({})", fmt::join(cases, " "))
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

std::string roles_text(const std::vector<machine::Role>& roles) {
  std::string out;
  for (const machine::Role role : roles) {
    if (!out.empty()) out += ", ";
    out += role_text(role);
  }
  return out;
}

std::string broken_text(const ImplementationRun& implementation) {
  std::string out;
  for (const RequirementSummary& rule : by_requirement(implementation)) {
    if (rule.broken == 0) continue;
    if (!out.empty()) out += ' ';
    out += trace::requirement_text(rule.requirement);
  }
  return out;
}

}  // namespace

std::string opening_text(const SuiteRun& run, const ImplementationRun& implementation,
                         std::size_t cases, const TextOptions& options) {
  const attach::Identity& who = implementation.identity;
  if (!implementation.dishonest.empty()) {
    return styled(options, "1;31", "REFUSED",
                  fmt::format("{}: {}. No answer of it could be believed, so nothing was run.",
                              implementation.target, implementation.dishonest)) +
           error_text(implementation.stderr_text, options);
  }
  std::string out = fmt::format("{} {} plays {}", who.name, who.version, roles_text(who.roles));
  if (who.real_time) out += " in real time";
  out += fmt::format("; {}, profile {}", counted(cases, "case"), run.profile);
  if (run.seed != 0) out += fmt::format(", seed {}", run.seed);
  if (!run.shard.empty()) out += fmt::format(", shard {}", run.shard);
  return wrapped("", out, options.width, kIndent.size());
}

std::string case_text(const CaseRun& one, const TextOptions& options) {
  if (options.quiet && !one.unexpected()) return {};
  std::string verdict(runner::verdict_text(one.result.verdict));
  const std::string_view style = style_of(one.result.verdict, one.unexpected());
  std::string rest;
  if (one.expectation == Expectation::kAsExpected) {
    rest = "as expected";
  } else if (one.expectation == Expectation::kUnexpectedPass) {
    rest = "was expected to fail";
  } else if (one.result.verdict != CaseVerdict::kPass) {
    rest = headline(one);
  }
  const std::string name = case_name(one);
  std::string out = fmt::format("{:<12} {}", verdict, name);
  if (!rest.empty()) {
    out = fmt::format("{:<12} {:<{}} {}", verdict, name, kNameColumns, rest);
    if (out.size() > options.width) out = out.substr(0, options.width - 3) + "...";
  }
  return painted(options, style, verdict) + out.substr(verdict.size()) + '\n';
}

std::string story_text(const SuiteRun& run, const ImplementationRun& implementation,
                       const TextOptions& options) {
  return Story(run, implementation, options).text();
}

std::string totals_text(const ImplementationRun& implementation, const TextOptions& options) {
  if (!implementation.dishonest.empty()) return {};
  const VerdictCounts counts = count(implementation);
  std::string out;
  for (const CaseVerdict verdict : kVerdicts) {
    const auto found = counts.find(verdict);
    if (found == counts.end()) continue;
    if (!out.empty()) out += ", ";
    out += fmt::format("{} {}", found->second, runner::verdict_text(verdict));
  }
  const RuleTotals rules = rule_totals(implementation);
  if (options.times) out += fmt::format(" in {:.2f} s", implementation.wall_ms / 1000);
  out = wrapped("", fmt::format("{}: {}.", implementation.identity.name, out), options.width,
                kIndent.size());
  out += wrapped(kIndent, fmt::format("Of {} rules {} tried: {} kept, {} broken, {} not decided.",
                                      rules.all, rules.all - rules.untried, rules.kept,
                                      rules.broken, rules.undecided), options.width);
  const std::string broken = broken_text(implementation);
  if (!broken.empty()) out += wrapped(fmt::format("{}Broken: ", kIndent), broken, options.width);
  return '\n' + out;
}

std::string changes_text(const SuiteRun& run, const EarlierRun& earlier, const std::string& name,
                         const TextOptions& options) {
  constexpr std::size_t kShown = 30;
  std::vector<std::string> changes;
  std::size_t unknown = 0;
  for (const ImplementationRun& implementation : run.implementations) {
    for (const CaseRun& one : implementation.cases) {
      if (one.repeat != 0) continue;
      const auto was = earlier.verdicts.find({implementation.identity.name, one.name});
      const std::string_view is = runner::verdict_text(one.result.verdict);
      if (was == earlier.verdicts.end()) {
        ++unknown;
      } else if (was->second != is) {
        changes.push_back(fmt::format("{}: {} was {}, is {}", implementation.identity.name,
                                      one.name, was->second, is));
      }
    }
  }
  std::string out = '\n' + wrapped("", fmt::format(
      "Since {}: {} with another verdict, {} that it does not have.", name,
      counted(changes.size(), "case"), counted(unknown, "case")), options.width, kIndent.size());
  for (std::size_t i = 0; i < changes.size() && (i < kShown || options.verbose); ++i) {
    out += wrapped(kIndent, changes[i], options.width);
  }
  if (changes.size() > kShown && !options.verbose) {
    out += fmt::format("{}and {} more\n", kIndent, changes.size() - kShown);
  }
  return out;
}

std::string closing_text(const SuiteRun& run, const TextOptions& options) {
  std::string out;
  if (!run.stale.empty()) out += '\n';
  for (const StaleExpectation& one : run.stale) {
    out += styled(options, "1;31", "NOT TRUE", one.place + ": " + one.text);
  }
  std::size_t failures = 0;
  std::size_t expected = 0;
  std::size_t errors = 0;
  std::size_t refused = 0;
  for (const ImplementationRun& implementation : run.implementations) {
    refused += !implementation.dishonest.empty();
    for (const CaseRun& one : implementation.cases) {
      const bool error = one.result.verdict == CaseVerdict::kError;
      errors += error;
      failures += one.unexpected() && !error;
      expected += one.expectation == Expectation::kAsExpected;
    }
  }
  const int code = exit_code(run);
  std::string text = counted(failures, "unexpected result");
  if (expected > 0) text += fmt::format(", {}", counted(expected, "expected failure"));
  if (!run.stale.empty()) {
    text += fmt::format(", {} not true", counted(run.stale.size(), "expectation"));
  }
  if (errors > 0) text += fmt::format(", {}", counted(errors, "error"));
  if (refused > 0) text += fmt::format(", {} refused", counted(refused, "implementation"));
  const char* verdict = code == 0 ? "as expected" : code == 1 ? "not as expected"
                        : code == 2 ? "broken" : "nothing was decided";
  out += '\n';
  return out + styled(options, code == 0 ? "1;32" : "1;31", "Verdict:",
                      fmt::format("{}: {}.", verdict, text));
}

}  // namespace rubric::suite
