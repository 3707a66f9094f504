#include "conformance/test/suite/expected.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "codec/reflect/requirements.h"
#include "conformance/generated/profiles.h"
#include "conformance/test/suite/select.h"

namespace rubric::suite {
namespace {

using report::KnownFailure;
using runner::CaseVerdict;
using runner::Failure;

constexpr const char* kNoRule = "none";
constexpr const char* kOfProfile =
    "The numbers and switches of the profile say so: the reference machine does it as well.";

std::string mistake(const std::string& rule) {
  if (rule == kNoRule || std::ranges::any_of(reflect::requirements(), [&](const auto& each) {
        return is_of(each.id, rule);
      })) {
    return {};
  }
  return fmt::format("no requirement is called '{}'; '{}' is for lines that name none", rule,
                     kNoRule);
}

bool is_about(const KnownFailure& one, const ImplementationRun& implementation,
              const CaseRun& run) {
  if (!is_like(one.cases, run.name)) return false;
  if (!one.profile.empty() && one.profile != run.profile) return false;
  return one.target.empty() || is_like(one.target, implementation.target) ||
         is_like(one.target, implementation.identity.name);
}

bool has_message(const KnownFailure& one, const Failure& failure) {
  return report::has_tokens(failure.text, one.message) ||
         report::has_tokens(failure.expected, one.message);
}

bool has_rule(const KnownFailure& one, const Failure& failure) {
  if (one.requirement == kNoRule) return failure.requirements.empty();
  return std::ranges::any_of(failure.rules(),
                             [&](const std::string& rule) { return is_of(rule, one.requirement); });
}

bool is_so(const KnownFailure& one, const CaseRun& run) {
  return std::any_of(run.result.failures.begin(), run.result.failures.end(),
                     [&](const Failure& f) { return has_rule(one, f) && has_message(one, f); });
}

// Returns the behaviour that the profile accepts instead, or null. For a missing output one
// accepted rule is enough; for a forbidden output each rule that forbids it has to be accepted.
const char* accepted(const machine::NamedProfile* profile, const Failure& failure) {
  if (failure.crash) return nullptr;
  const char* sentence = nullptr;
  for (const std::string& rule : failure.rules()) {
    const char* found = nullptr;
    for (const machine::AcceptedDifference& one : profile->accepted) {
      if (trace::requirement_id(rule) == one.requirement) found = one.sentence;
    }
    if (!found && failure.forbidden) return nullptr;
    if (!sentence) sentence = found;
  }
  return sentence;
}

bool is_decided(const CaseRun& one) {
  return !one.undecided() && one.result.verdict != CaseVerdict::kError;
}

// Sets whether the file says why a case is not decided.
void excuse(const report::KnownFailures& expected, const ImplementationRun& implementation,
            CaseRun& one) {
  for (const KnownFailure& entry : expected.entries) {
    if (!entry.skip || !is_about(entry, implementation, one)) continue;
    one.owed = false;
    one.expected_reason = entry.reason;
    return;
  }
}

std::string why_untrue(const KnownFailure& entry, const CaseRun& one) {
  const std::string was = fmt::format("{} was expected to break {} with \"{}\"", one.name,
                                      entry.requirement, entry.message);
  if (one.result.failures.empty()) {
    return was + ", but passes. If that is meant, delete the expectation.";
  }
  const Failure& first = one.result.failures.front();
  return fmt::format("{}, but line {} of {} says: {}", was, first.place.line, one.file, first.text);
}

// The first that is not so tells the rest of those that a glob stands for.
std::string why_untrue(const KnownFailure& entry, const std::vector<const CaseRun*>& untrue,
                       std::size_t asked) {
  constexpr std::size_t kNamed = 5;
  std::string first = why_untrue(entry, *untrue.front());
  if (asked == 1) return first;
  std::vector<std::string> names;
  for (const CaseRun* one : untrue) {
    if (names.empty() || names.back() != one->name) names.push_back(one->name);
  }
  if (names.size() > kNamed) {
    names.resize(kNamed);
    names.emplace_back("...");
  }
  return fmt::format("{} of the {} runs that '{}' names do not fail so ({}). The first: {}",
                     untrue.size(), asked, entry.cases, fmt::join(names, ", "), first);
}

}  // namespace

report::KnownFailures parse_expected(std::string_view text, const std::string& name) {
  return report::parse_known_failures(text, name, report::KnownTo::kTest, mistake);
}

void expect(const report::KnownFailures& expected, const ImplementationRun& implementation,
            CaseRun& one) {
  if (one.undecided()) excuse(expected, implementation, one);
  if (!is_decided(one)) return;
  std::vector<const KnownFailure*> entries;
  for (const KnownFailure& entry : expected.entries) {
    if (!entry.skip && is_about(entry, implementation, one)) entries.push_back(&entry);
  }
  const machine::NamedProfile* dialect = machine::find_profile(one.profile);
  bool all_known = true;  // Each failure that is no SHOULD.
  for (const Failure& failure : one.result.failures) {
    const char* reason = dialect ? accepted(dialect, failure) : nullptr;
    const auto& lines = one.lines_of_profile;
    if (!reason && !failure.crash &&
        std::find(lines.begin(), lines.end(), failure.place.line) != lines.end()) {
      reason = kOfProfile;
    }
    for (const KnownFailure* entry : entries) {
      if (has_rule(*entry, failure) && has_message(*entry, failure)) reason = entry->reason.c_str();
    }
    if (reason && one.expected_reason.empty()) one.expected_reason = reason;
    all_known = all_known && (reason || failure.weak);
  }
  const bool all_true = std::all_of(entries.begin(), entries.end(),
                                    [&](const auto* entry) { return is_so(*entry, one); });
  const bool passed = one.result.failures.empty();
  if (passed && entries.empty()) return;
  if (passed) {
    one.expectation = Expectation::kUnexpectedPass;
    one.expected_reason = entries.front()->reason;
  } else if (!all_true) {
    one.expectation = Expectation::kOtherwise;
    if (one.expected_reason.empty()) one.expected_reason = entries.front()->reason;
  } else if (!one.expected_reason.empty()) {
    one.expectation = all_known ? Expectation::kAsExpected : Expectation::kOtherwise;
  }
}

std::optional<std::string> reason_of(const report::KnownFailures& expected,
                                     const ImplementationRun& implementation, const CaseRun& one,
                                     const Failure& failure) {
  for (const KnownFailure& entry : expected.entries) {
    if (!entry.skip && is_about(entry, implementation, one) && has_rule(entry, failure) &&
        has_message(entry, failure)) {
      return entry.reason;
    }
  }
  return std::nullopt;
}

std::vector<StaleExpectation> stale_expectations(const report::KnownFailures& expected,
                                                 const SuiteRun& run, const Cases& all) {
  std::vector<StaleExpectation> out;
  for (const KnownFailure& entry : expected.entries) {
    const std::string place = fmt::format("{}:{}", expected.name, entry.line);
    const bool exists = std::any_of(all.all().begin(), all.all().end(), [&](const SuiteCase& one) {
      return is_like(entry.cases, one.one->name);
    });
    if (!exists) {
      out.push_back({place, fmt::format("no case is called '{}'", entry.cases)});
      continue;
    }
    std::vector<const CaseRun*> asked;
    bool undecided = false;
    for (const ImplementationRun& implementation : run.implementations) {
      for (const CaseRun& one : implementation.cases) {
        if (!is_about(entry, implementation, one)) continue;
        if (is_decided(one)) asked.push_back(&one);
        undecided = undecided || !is_decided(one);
      }
    }
    if (entry.skip) {
      if (!undecided && !asked.empty()) {
        out.push_back({place, fmt::format("{} is listed as skipped, but was decided: delete it",
                                          entry.cases)});
      }
      continue;
    }
    std::vector<const CaseRun*> untrue;
    std::copy_if(asked.begin(), asked.end(), std::back_inserter(untrue),
                 [&](const CaseRun* one) { return !is_so(entry, *one); });
    if (!untrue.empty()) out.push_back({place, why_untrue(entry, untrue, asked.size())});
  }
  return out;
}

}  // namespace rubric::suite
