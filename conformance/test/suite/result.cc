#include "conformance/test/suite/result.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "codec/reflect/fault_text.h"
#include "codec/reflect/requirements.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;

bool is_decided(CaseVerdict verdict) {
  return verdict == CaseVerdict::kPass || verdict == CaseVerdict::kWeak ||
         verdict == CaseVerdict::kFail;
}

std::set<ReqId, reflect::CatalogueOrder> broken_rules(const CaseRun& one) {
  std::set<ReqId, reflect::CatalogueOrder> out;
  for (const runner::Failure& failure : one.result.failures) {
    for (const std::string& name : failure.requirements) out.insert(trace::requirement_id(name));
  }
  return out;
}

}  // namespace

bool CaseRun::unexpected() const {
  if (result.verdict == CaseVerdict::kError) return true;
  if (result.verdict == CaseVerdict::kFail) return expectation != Expectation::kAsExpected;
  return expectation == Expectation::kOtherwise || expectation == Expectation::kUnexpectedPass;
}

int exit_code(const SuiteRun& run) {
  bool broke = false;
  bool failed = !run.stale.empty();
  bool decided = false;
  for (const ImplementationRun& implementation : run.implementations) {
    broke = broke || !implementation.dishonest.empty();
    for (const OutsideFault& one : implementation.outside) broke = broke || one.broke;
    for (const CaseRun& one : implementation.cases) {
      broke = broke || one.result.verdict == CaseVerdict::kError;
      failed = failed || one.unexpected();
      decided = decided || is_decided(one.result.verdict);
    }
  }
  return broke ? 2 : failed ? 1 : decided ? 0 : 3;
}

VerdictCounts count(const ImplementationRun& run) {
  VerdictCounts out;
  for (const CaseRun& one : run.cases) ++out[one.result.verdict];
  return out;
}

std::vector<RequirementSummary> by_requirement(const ImplementationRun& run) {
  std::map<ReqId, RequirementSummary, reflect::CatalogueOrder> rules;
  for (const CaseRun& one : run.cases) {
    const auto broken = broken_rules(one);
    for (const ReqId id : one.requirements) {
      RequirementSummary& rule = rules[id];
      rule.requirement = id;
      ++rule.cases[one.result.verdict];
      if (broken.contains(id)) ++rule.broken;
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
    if (std::string_view(reflect::requirement(rule.requirement).id).starts_with("WIRE-")) continue;
    const auto cases = [&](CaseVerdict verdict) {
      const auto found = rule.cases.find(verdict);
      return found == rule.cases.end() ? 0 : found->second;
    };
    if (rule.broken > 0) {
      ++totals.broken;
    } else if (cases(CaseVerdict::kPass) + cases(CaseVerdict::kWeak) > 0) {
      ++totals.kept;
    } else if (cases(CaseVerdict::kFail) + cases(CaseVerdict::kError) +
                   cases(CaseVerdict::kInconclusive) >
               0) {
      ++totals.undecided;
    }
  }
  totals.untried = totals.all - totals.kept - totals.broken - totals.undecided;
  return totals;
}

}  // namespace rubric::suite
