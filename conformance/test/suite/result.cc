#include "conformance/test/suite/result.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "codec/reflect/requirements.h"
#include "codec/text/text.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;

using Rules = std::set<ReqId, reflect::CatalogueOrder>;

// Returns the rules that the failures of a case blame, or else name.
Rules rules_of(const CaseRun& one, bool blamed) {
  Rules out;
  for (const runner::Failure& failure : one.result.failures) {
    for (const std::string& name : failure.rules()) {
      const bool first = !failure.requirements.empty() && name == failure.requirements.front();
      if (!blamed || (first && !failure.implied)) out.insert(trace::requirement_id(name));
    }
  }
  return out;
}

// Returns whether a case that names the rule passed, or one broke it.
bool is_decided(const ImplementationRun& implementation, ReqId rule) {
  return std::ranges::any_of(by_requirement(implementation), [&](const RequirementSummary& one) {
    return one.requirement == rule &&
           (one.broken > 0 || one.cases.contains(runner::CaseVerdict::kPass));
  });
}

// Says of a role how little is left of its cases where what is stated rules most of them out.
std::string ruled_out_most(const ImplementationRun& implementation) {
  for (const machine::Role role : implementation.identity.roles) {
    const RuledOut out = ruled_out(implementation, role);
    if (2 * out.left >= out.all) continue;
    return fmt::format("{} of {} of a {} could be tried: {}", out.left,
                       text::counted(out.all, "case"),
                       trace::role_text(static_cast<trace::Role>(role)), out.by);
  }
  return {};
}

}  // namespace

bool CaseRun::undecided() const {
  return result.verdict == CaseVerdict::kSkip || result.verdict == CaseVerdict::kInconclusive;
}

bool CaseRun::unexpected() const {
  if (result.verdict == CaseVerdict::kError || owed) return true;
  if (result.verdict == CaseVerdict::kFail) return expectation != Expectation::kAsExpected;
  return expectation == Expectation::kOtherwise || expectation == Expectation::kUnexpectedPass;
}

int exit_code(const SuiteRun& run) {
  bool broke = false;
  bool failed = !run.stale.empty();
  bool complete = true;
  for (const ImplementationRun& implementation : run.implementations) {
    broke = broke || !implementation.dishonest.empty();
    for (const OutsideFault& one : implementation.outside) broke = broke || one.broke;
    for (const CaseRun& one : implementation.cases) {
      broke = broke || one.result.verdict == CaseVerdict::kError;
      failed = failed || (one.unexpected() && !one.owed);
    }
    complete = complete && incomplete(run, implementation).empty();
  }
  return broke ? 2 : failed ? 1 : complete ? 0 : 3;
}

RuledOut ruled_out(const ImplementationRun& implementation, std::optional<machine::Role> role) {
  RuledOut out;
  std::map<std::string, std::size_t> cases_of;  // By what is stated.
  for (const CaseRun& one : implementation.cases) {
    if (role && std::ranges::find(one.roles, *role) == one.roles.end()) continue;
    if (one.foreign && one.ruled_out.empty()) continue;
    ++out.all;
    if (one.ruled_out.empty()) ++out.left;
    if (!one.ruled_out.empty()) ++cases_of[one.ruled_out];
  }
  for (const auto& [stated, cases] : cases_of) {
    out.by += fmt::format("{}{} rules out {}", out.by.empty() ? "" : ", ", stated, cases);
  }
  return out;
}

std::string incomplete(const SuiteRun& run, const ImplementationRun& implementation) {
  std::size_t decided = 0;
  std::size_t owed = 0;
  for (const CaseRun& one : implementation.cases) {
    decided += !one.undecided();
    owed += one.owed;
  }
  const RuleTotals rules = rule_totals(implementation);
  const std::size_t rules_decided = rules.kept + rules.broken + rules.suspected;
  if (decided == 0) return "nothing was decided";
  if (std::string most = ruled_out_most(implementation); !most.empty()) return most;
  if (owed > 0) {
    return fmt::format("{} {} neither decided nor listed with a reason",
                       text::counted(owed, "case"), owed == 1 ? "is" : "are");
  }
  for (const OutsideFault& one : implementation.outside) {
    if (one.open == ReqId::kNone || is_decided(implementation, one.open)) continue;
    return fmt::format("{} is not decided, for it {}, {}; --app lets cases decide it",
                       trace::requirement_text(one.open), one.text, one.when);
  }
  if (rules_decided < run.rules_required) {
    return fmt::format("{} decided, of {} required", text::counted(rules_decided, "rule"),
                       run.rules_required);
  }
  return {};
}

VerdictCounts count(const ImplementationRun& run) {
  VerdictCounts out;
  for (const CaseRun& one : run.cases) ++out[one.result.verdict];
  return out;
}

std::vector<RequirementSummary> by_requirement(const ImplementationRun& run) {
  std::map<ReqId, RequirementSummary, reflect::CatalogueOrder> rules;
  for (const CaseRun& one : run.cases) {
    const Rules broken = rules_of(one, true);
    const Rules named = rules_of(one, false);
    // A frame's size is judged wherever it comes, though no line names its rule.
    Rules all = broken;
    all.insert(one.requirements.begin(), one.requirements.end());
    for (const ReqId id : all) {
      if (id == ReqId::kNone) continue;
      RequirementSummary& rule = rules[id];
      rule.requirement = id;
      ++rule.cases[one.result.verdict];
      rule.broken += broken.contains(id);
      rule.suspected += named.contains(id) && !broken.contains(id);
    }
  }
  std::vector<RequirementSummary> out;
  for (auto& [id, rule] : rules) out.push_back(std::move(rule));
  return out;
}

RuleTotals rule_totals(const ImplementationRun& run) {
  RuleTotals totals;
  for (const reflect::Requirement& rule : reflect::requirements()) {
    const std::string_view id = rule.id;
    totals.all += !id.empty() && !id.starts_with("WIRE-");
  }
  for (const RequirementSummary& rule : by_requirement(run)) {
    if (std::string_view(reflect::requirement(rule.requirement).id).starts_with("WIRE-")) {
      totals.all += rule.broken > 0;
      totals.broken += rule.broken > 0;
      continue;
    }
    const auto cases = [&](CaseVerdict verdict) {
      const auto found = rule.cases.find(verdict);
      return found == rule.cases.end() ? 0 : found->second;
    };
    if (rule.broken > 0) {
      ++totals.broken;
    } else if (rule.suspected > 0) {
      ++totals.suspected;
    } else if (cases(CaseVerdict::kPass) + cases(CaseVerdict::kWeak) > 0) {
      ++totals.kept;
    } else if (cases(CaseVerdict::kFail) + cases(CaseVerdict::kError) +
                   cases(CaseVerdict::kInconclusive) >
               0) {
      ++totals.undecided;
    }
  }
  totals.untried = totals.all - totals.kept - totals.broken - totals.suspected - totals.undecided;
  return totals;
}

}  // namespace rubric::suite
