#include "conformance/test/report/compare.h"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "conformance/test/report/words.h"

namespace rubric::suite {
namespace {

EarlierKey key_of(const SuiteRun& run, std::size_t implementation, const CaseRun& one) {
  return {run.implementations[implementation].identity.name, one.name,
          which_of_name(run, implementation), one.repeat};
}

// Returns the name that this run has for it, if it has it.
std::string name_of(const SuiteRun& run, const EarlierKey& key) {
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    if (run.implementations[i].identity.name == key.implementation &&
        which_of_name(run, i) == key.which) {
      return implementation_name(run, i);
    }
  }
  return key.which == 0 ? key.implementation
                        : fmt::format("{} #{}", key.implementation, key.which + 1);
}

}  // namespace

std::size_t which_of_name(const SuiteRun& run, std::size_t implementation) {
  const std::string& name = run.implementations[implementation].identity.name;
  std::size_t before = 0;
  for (std::size_t i = 0; i < implementation; ++i) {
    before += run.implementations[i].identity.name == name;
  }
  return before;
}

std::string earlier_verdict(const EarlierRun& earlier, const SuiteRun& run,
                            std::size_t implementation, const CaseRun& one) {
  const auto found = earlier.verdicts.find(key_of(run, implementation, one));
  return found == earlier.verdicts.end() ? std::string() : found->second;
}

Comparison compare(const SuiteRun& run, const EarlierRun& earlier) {
  Comparison out;
  std::set<EarlierKey> here;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    for (const CaseRun& one : run.implementations[i].cases) {
      here.insert(key_of(run, i, one));
      Change change{implementation_name(run, i), case_name(one),
                    earlier_verdict(earlier, run, i, one),
                    std::string(runner::verdict_text(one.result.verdict))};
      if (change.was == change.is) continue;
      (change.was.empty() ? out.added : out.changed).push_back(std::move(change));
    }
  }
  for (const auto& [key, verdict] : earlier.verdicts) {
    if (here.contains(key)) continue;
    CaseRun one{.name = key.case_name, .repeat = key.repeat};
    out.gone.push_back({name_of(run, key), case_name(one), verdict, {}});
  }
  return out;
}

}  // namespace rubric::suite
