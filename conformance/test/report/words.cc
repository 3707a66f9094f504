#include "conformance/test/report/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "codec/reflect/fault_text.h"
#include "codec/text/shell.h"
#include "codec/text/text.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/trace/print.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {
namespace {

std::string base_name(const ImplementationRun& run) {
  const targets::Identity& identity = run.identity;
  if (identity.name.empty()) return run.target;
  return identity.version.empty() ? identity.name : identity.name + " " + identity.version;
}

// A broken target has no rule, and a line of a case need not name one.
std::string rules_of(const runner::Failure& failure) {
  return fmt::format("{}", fmt::join(failure.requirements, " "));
}

// Returns what should have happened: "expected m5 > app joined(result=fail ...), but ".
std::string asked_text(const runner::Failure& failure) {
  if (failure.forbidden) return "forbidden, but ";
  const std::optional<trace::Line> asked = asked_line(failure);
  if (!asked) return {};
  return fmt::format("expected {} {} {} {}, but ", asked->node, trace::op_text(asked->op),
                     asked->link, trace::print(asked->message));
}

// Says how many cases can be decided where a part of the node's links is shown.
std::string reach_text(const ImplementationRun& implementation) {
  std::size_t played = 0;
  std::size_t beyond = 0;
  std::set<std::string> unseen;
  for (const CaseRun& one : implementation.cases) {
    played += one.result.verdict != runner::CaseVerdict::kSkip;
    if (!is_beyond_reach(one)) continue;
    ++beyond;
    unseen.insert(one.result.unseen.begin(), one.result.unseen.end());
  }
  if (beyond == 0) return {};
  return fmt::format(
      "The attached links decide {} of {}; the others need {} as well (conformance/PORTING.md; "
      "--app shows more of a node at its line).",
      played - beyond, text::counted(played, "case"), fmt::join(unseen, ", "));
}

// Says how many cases would pass if a radio's wait for its channel were stated.
std::string access_text(const ImplementationRun& implementation) {
  std::size_t cases = 0;
  runner::Ticks access = 0;
  for (const CaseRun& one : implementation.cases) {
    if (one.channel_access == 0) continue;
    ++cases;
    access = one.channel_access;
  }
  if (cases == 0) return {};
  return fmt::format(
      "{} would pass with --state channel_access={}: state it if the radio waits for a free "
      "channel before it sends (decision 128).",
      text::counted(cases, "failed case"), access);
}

}  // namespace

std::string_view role_text(machine::Role role) {
  return trace::role_text(static_cast<trace::Role>(role));
}

std::string_view expectation_text(Expectation expectation) {
  switch (expectation) {
    case Expectation::kNone: return "none";
    case Expectation::kAsExpected: return "as_expected";
    case Expectation::kOtherwise: return "otherwise";
    case Expectation::kUnexpectedPass: return "unexpected_pass";
  }
  return "none";
}

std::string implementation_name(const SuiteRun& run, std::size_t index) {
  const std::string name = base_name(run.implementations[index]);
  std::size_t before = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    if (base_name(run.implementations[i]) != name) continue;
    ++all;
    if (i < index) ++before;
  }
  return all == 1 ? name : fmt::format("{} #{}", name, before + 1);
}

std::string case_name(const CaseRun& one) {
  return one.repeat == 0 ? one.name : fmt::format("{}#{}", one.name, one.repeat + 1);
}

std::string what_broke(const CaseRun& one) {
  const std::string& reason = one.result.reason;
  const std::size_t behind = reason.starts_with('`') ? reason.find("`: ") : reason.npos;
  return behind == reason.npos ? reason : reason.substr(behind + 3);
}

std::string headline(const CaseRun& one) {
  if (one.expectation == Expectation::kUnexpectedPass) {
    return "it passes, but was expected to fail: " + one.expected_reason;
  }
  const bool crashed = !one.result.failures.empty() && one.result.failures.front().crash;
  if (one.result.verdict == runner::CaseVerdict::kError || crashed) {
    const std::string what = what_broke(one);
    std::string asked = one.result.reason.substr(0, one.result.reason.size() - what.size());
    if (!asked.empty()) asked = ", at " + asked.substr(0, asked.size() - 2);
    const std::string rules = crashed ? rules_of(one.result.failures.front()) : std::string();
    return (rules.empty() ? "" : rules + ": ") + what + asked;
  }
  if (one.result.failures.empty()) return one.result.reason;
  const runner::Failure& first = one.result.failures.front();
  const std::string rules = rules_of(first);
  const std::string cause = first.cause.empty() ? "" : ", perhaps of " + first.cause;
  std::string out = (rules.empty() ? "" : rules + cause + ": ") + asked_text(first) + first.text;
  if (one.result.failures.size() > 1) {
    out += fmt::format(" (and {} more)", one.result.failures.size() - 1);
  }
  return out;
}

std::string in_full(const CaseRun& one) {
  std::string out;
  for (const runner::Failure& failure : one.result.failures) {
    const std::string place = fmt::format("{}:{}: ", one.file, failure.place.line);
    const std::string rules = rules_of(failure);
    if (rules.empty() && failure.expected.empty()) {
      out += place + failure.text + '\n';
      continue;
    }
    const std::string suspected = fmt::format("{}", fmt::join(failure.suspected, " "));
    out += fmt::format("{}{}{}{}{}\n", place, rules.empty() ? "a line that names no rule" : rules,
                       suspected.empty() ? "" : ", suspected " + suspected,
                       failure.weak ? " (SHOULD)" : "",
                       !failure.cause.empty() ? " (perhaps of " + failure.cause + ")"
                       : failure.implied      ? " (implied by what is above)"
                                              : "");
    for (const std::string& name : failure.requirements) {
      const ReqId id = trace::requirement_id(name);
      if (id == ReqId::kNone) continue;
      const reflect::Requirement& rule = reflect::requirement(id);
      out += fmt::format("  {} ({}): {}\n", rule.id, rule.level, rule.sentence);
    }
    if (!failure.expected.empty()) out += fmt::format("  expected  {}\n", failure.expected);
    out += fmt::format("  but       {}\n", failure.text);
  }
  if (one.result.failures.empty() && !one.result.reason.empty()) out += one.result.reason + "\n";
  if (!one.stderr_text.empty()) out += "standard error:\n" + one.stderr_text + "\n";
  return out;
}

std::string incomplete_as_a_whole(const SuiteRun& run, const ImplementationRun& implementation) {
  const auto is_owed = [](const CaseRun& one) { return one.owed; };
  if (!implementation.dishonest.empty() || std::ranges::any_of(implementation.cases, is_owed)) {
    return {};
  }
  return incomplete(run, implementation);
}

bool broke_outside(const ImplementationRun& implementation) {
  const auto& all = implementation.outside;
  return std::any_of(all.begin(), all.end(), [](const OutsideFault& one) { return one.broke; });
}

bool is_beyond_reach(const CaseRun& one) {
  return one.result.verdict == runner::CaseVerdict::kInconclusive && !one.result.unseen.empty();
}

std::string outside_text(const OutsideFault& fault) { return fault.text + ", " + fault.when; }

std::string outside_headline(const ImplementationRun& implementation) {
  const auto& all = implementation.outside;
  if (all.empty()) return {};
  const auto gravest = std::max_element(
      all.begin(), all.end(),
      [](const OutsideFault& a, const OutsideFault& b) { return a.broke < b.broke; });
  std::string out = outside_text(*gravest);
  if (all.size() > 1) out += fmt::format(" (and {} more)", all.size() - 1);
  return out;
}

std::vector<std::string> advice(const ImplementationRun& implementation) {
  std::vector<std::string> out;
  for (std::string text : {reach_text(implementation), access_text(implementation)}) {
    if (!text.empty()) out.push_back(std::move(text));
  }
  return out;
}

std::string replay_command(const SuiteRun& run, const ImplementationRun& implementation,
                           const CaseRun& one) {
  std::string out = "rubric test ";
  if (!run.protocol.empty()) out += "--protocol " + text::shell_word(run.protocol) + ' ';
  out += "--target " + text::shell_word(implementation.target) + " --cases " +
         text::shell_word(one.name);
  if (!run.app.empty()) out += " --app " + text::shell_word(run.app);
  for (const trace::Stated& stated : run.stated) {
    out += " --state " + trace::statement_text({stated});
  }
  if (!run.profile.empty() && run.profile != "paper") out += " --profile " + run.profile;
  if (one.seed != 0) out += fmt::format(" --seed {}", one.seed);
  for (const std::string& path : run.traces) out += " " + text::shell_word(path);
  return out;
}

std::string what_was_missing(const std::string& reason) {
  const std::size_t end = reason.find("`: ");
  if (!reason.starts_with('`') || end == std::string::npos) return reason;
  const std::string_view command = std::string_view(reason).substr(1, end - 1);
  const std::size_t verb = command.find(' ');
  const std::size_t name = command.find_first_not_of("0123456789 ", verb);
  if (verb == command.npos || name == command.npos) return reason;
  const std::string_view what = command.substr(name, command.find_first_of("( ", name) - name);
  return fmt::format("{} {}{}", command.substr(0, verb), what, reason.substr(end + 1));
}

}  // namespace rubric::suite
