// The text before and after the cases.
#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "codec/text/text.h"
#include "conformance/test/report/text/style.h"
#include "conformance/test/report/text/text.h"
#include "conformance/test/report/words.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;
using text::counted;
using text::wrapped;

std::string roles_text(const std::vector<machine::Role>& roles) {
  std::string out;
  for (const machine::Role role : roles) {
    if (!out.empty()) out += ", ";
    out += role_text(role);
  }
  return out;
}

// Names the rules of a list after `title`; empty if there are none.
template <class Takes>
std::string rules_line(const ImplementationRun& implementation, const char* title,
                       const TextOptions& options, Takes takes) {
  std::string out;
  for (const RequirementSummary& rule : by_requirement(implementation)) {
    if (!takes(rule)) continue;
    if (!out.empty()) out += ' ';
    out += trace::requirement_text(rule.requirement);
  }
  return out.empty() ? out : wrapped(fmt::format("{}{}: ", kIndent, title), out, options.width);
}

// Says how many cases the stated parameters leave.
std::string stated_text(const ImplementationRun& implementation, const TextOptions& options) {
  const RuledOut out = ruled_out(implementation);
  if (out.by.empty()) return {};
  return wrapped(kIndent,
                 fmt::format("The stated parameters leave {} of {}: {}.", out.left,
                             counted(out.all, "case"), out.by),
                 options.width);
}

// Describes faults that happened between cases.
std::string outside(const ImplementationRun& implementation, const TextOptions& options) {
  constexpr std::size_t kShown = 4;
  const std::vector<OutsideFault>& all = implementation.outside;
  std::string out;
  for (std::size_t i = 0; i < all.size() && (i < kShown || options.verbose); ++i) {
    out += wrapped(fmt::format("{}{}: ", kIndent, all[i].broke ? "Broke" : "Note"),
                   fmt::format("it {}.", outside_text(all[i])), options.width);
    out += error_text(all[i].stderr_text, options);
  }
  if (all.size() > kShown && !options.verbose) {
    out += fmt::format("{}and {} more\n", kIndent, all.size() - kShown);
  }
  return out;
}

template <class Say>
std::string list_of(const std::vector<Change>& changes, const TextOptions& options, Say say) {
  constexpr std::size_t kShown = 20;
  std::string out;
  for (std::size_t i = 0; i < changes.size() && (i < kShown || options.verbose); ++i) {
    out += wrapped(
        kIndent,
        fmt::format("{}: {} {}", changes[i].implementation, changes[i].case_name, say(changes[i])),
        options.width);
  }
  if (changes.size() > kShown && !options.verbose) {
    out += fmt::format("{}and {} more; --verbose names them\n", kIndent, changes.size() - kShown);
  }
  return out;
}

}  // namespace

std::string opening_text(const SuiteRun& run, const ImplementationRun& implementation,
                         std::size_t cases, const TextOptions& options) {
  const targets::Identity& who = implementation.identity;
  if (!implementation.dishonest.empty()) {
    return styled(options, "1;31", "REFUSED",
                  fmt::format("{}: {}. No answer of it could be believed, so nothing was run.",
                              implementation.target, implementation.dishonest)) +
           error_text(implementation.stderr_text, options);
  }
  std::string out = fmt::format("{} {} plays {}", who.name, who.version, roles_text(who.roles));
  if (who.real_time) out += " in real time";
  out += "; " + counted(cases, "case");
  if (!run.profile.empty()) out += ", profile " + run.profile;
  if (run.seed != 0) out += fmt::format(", seed {}", run.seed);
  if (!run.shard.empty()) out += fmt::format(", shard {}", run.shard);
  if (!who.stated.empty()) out += "; states " + trace::statement_text(who.stated);
  return wrapped("", out, options.width, kIndent.size());
}

std::string totals_text(const SuiteRun& run, const ImplementationRun& implementation,
                        const TextOptions& options) {
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
  out += wrapped(
      kIndent,
      fmt::format("Of {} rules {} tried: {} kept, {} broken, {}{} not decided.", rules.all,
                  rules.all - rules.untried, rules.kept, rules.broken,
                  rules.suspected == 0 ? "" : fmt::format("{} suspected, ", rules.suspected),
                  rules.undecided),
      options.width);
  const std::string missing = incomplete(run, implementation);
  if (!missing.empty())
    out += wrapped(fmt::format("{}Incomplete: ", kIndent), missing + '.', options.width);
  out += stated_text(implementation, options);
  for (const std::string& one : advice(implementation)) {
    out += wrapped(kIndent, one, options.width);
  }
  out += outside(implementation, options);
  out += rules_line(implementation, "Broken", options,
                    [](const RequirementSummary& rule) { return rule.broken > 0; });
  out += rules_line(implementation, "Suspected", options, [](const RequirementSummary& rule) {
    return rule.broken == 0 && rule.suspected > 0;
  });
  return '\n' + out;
}

std::string changes_text(const SuiteRun& run, const EarlierRun& earlier, const std::string& name,
                         const TextOptions& options) {
  const Comparison since = compare(run, earlier);
  std::string out =
      '\n' +
      wrapped(
          "",
          fmt::format("Since {}: {} with another verdict, {} new, {} gone or not chosen.", name,
                      counted(since.changed.size(), "case"), since.added.size(), since.gone.size()),
          options.width, kIndent.size());
  out += list_of(since.changed, options,
                 [](const Change& one) { return fmt::format("was {}, is {}", one.was, one.is); });
  out += list_of(since.added, options,
                 [](const Change& one) { return fmt::format("is new: {}", one.is); });
  return out + list_of(since.gone, options,
                       [](const Change& one) { return fmt::format("is gone, was {}", one.was); });
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
  std::size_t broken = 0;
  std::size_t owed = 0;
  for (const ImplementationRun& implementation : run.implementations) {
    refused += !implementation.dishonest.empty();
    broken += broke_outside(implementation);
    for (const CaseRun& one : implementation.cases) {
      const bool error = one.result.verdict == CaseVerdict::kError;
      errors += error;
      failures += one.unexpected() && !error && !one.owed;
      owed += one.owed;
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
  if (broken > 0) {
    text += fmt::format(", {} broke between cases", counted(broken, "implementation"));
  }
  if (owed > 0) text += fmt::format(", {} not decided", counted(owed, "case"));
  constexpr std::array kVerdictOfCode = {"as expected", "not as expected", "broken", "incomplete"};
  const char* const verdict = kVerdictOfCode.at(static_cast<std::size_t>(code));
  out += '\n';
  return out + styled(options, code == 0 ? "1;32" : "1;31",
                      "Verdict:", fmt::format("{}: {}.", verdict, text));
}

}  // namespace rubric::suite
