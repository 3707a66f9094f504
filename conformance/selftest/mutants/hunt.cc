#include "conformance/selftest/mutants/hunt.h"

#include <algorithm>
#include <atomic>
#include <set>
#include <thread>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/headers.h"
#include "conformance/trace/print.h"

namespace rubric::mutants {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;

bool names(const std::vector<std::string>& requirements, const Mutant& mutant) {
  return std::any_of(requirements.begin(), requirements.end(), [&](const std::string& name) {
    const auto& wanted = mutant.requirements;
    return std::find(wanted.begin(), wanted.end(), trace::requirement_id(name)) != wanted.end();
  });
}

bool speaks_of(const trace::Case& one, const Mutant& mutant) {
  const auto lines = one.lines();
  return std::any_of(lines.begin(), lines.end(),
                     [&](const trace::Line* line) { return names(line->requirements, mutant); });
}

Blame blame(const std::set<std::string>& rules, const Mutant& mutant) {
  Blame out;
  for (const std::string& rule : rules) {
    ++out.rules;
    out.right += names({rule}, mutant);
  }
  return out;
}

// Returns false to go on with the next case.
bool judge(const CaseRef& ref, const Mutant& mutant, Found& found) {
  const CaseResult result = run(ref, mutant.factory());
  if (result.verdict == CaseVerdict::kPass) return false;
  const bool named =
      mutant.requirements.empty() ||
      std::any_of(result.failures.begin(), result.failures.end(),
                  [&](const auto& failure) { return names(failure.rules(), mutant); });
  if (!found.killed || named) {
    found.by = ref.one->name;
    found.lines = runner::explain(result, ref.file->file_name);
    std::set<std::string> all;
    std::set<std::string> blamed;
    for (const runner::Failure& failure : result.failures) {
      for (const std::string& rule : failure.rules()) all.insert(rule);
      if (!failure.implied) blamed.insert(failure.requirements.begin(), failure.requirements.end());
    }
    found.named_there = blame(all, mutant);
    found.blamed_there = blame(blamed, mutant);
  }
  found.killed = true;
  found.named = named;
  return named;
}

class Watched : public runner::Machine {
 public:
  explicit Watched(const Witness& see) : see_(see) {}
  void step(Ticks now, const Event& event, Actions& actions) override {
    const State before = state_;
    Machine::step(now, event, actions);
    see_(before, now, event, state_, actions);
  }

 private:
  const Witness& see_;
};

CaseResult run_watched(const CaseRef& ref, const Witness& see) {
  return run(ref, [&] { return std::make_unique<Watched>(see); });
}

}  // namespace

Golden::Golden(const std::string& folder) : Golden(runner::load_cases(folder)) {}

Golden::Golden(std::vector<trace::Parsed> files) : files_(std::move(files)) {
  for (const trace::Parsed& file : files_) {
    for (const trace::Case& one : file.file.cases) {
      const CaseRef ref{&file, &one};
      std::set<std::string>& kinds = kinds_[one.name];
      const CaseResult result =
          run_watched(ref, [&](const State&, Ticks, const Event&, const State&,
                               const Actions& actions) { kinds.merge(kinds_of(actions)); });
      (result.verdict == CaseVerdict::kPass ? cases_ : broken_).push_back(ref);
    }
  }
}

bool Golden::acts(const Mutant& mutant, const std::string& case_name) const {
  return mutant.acts_on.empty() || kinds_.at(case_name).contains(mutant.acts_on);
}

void watch(const Golden& golden, const Witness& see) {
  for (const CaseRef& ref : golden.cases()) run_watched(ref, see);
}

CaseResult run(const CaseRef& ref, const runner::SubjectFactory& make) {
  return runner::run_case(ref.file->file, *ref.one, [&](const trace::NodeHeader&) {
    return std::make_unique<runner::SubjectTarget>(make());
  });
}

CaseResult run(const CaseRef& ref, const runner::SubjectFactory& make,
               const trace::Statement& stated) {
  trace::Parsed file;
  file.file.head = ref.file->file.head;
  trace::Case one = *ref.one;
  CaseResult result{.reason = trace::state(file.file, one, stated).text};
  if (result.reason.empty()) return run({&file, &one}, make);
  result.verdict = CaseVerdict::kSkip;
  return result;
}

Found hunt(const Golden& golden, const Mutant& mutant) {
  Found found;
  for (const bool first : {true, false}) {
    for (const CaseRef& ref : golden.cases()) {
      if (!golden.acts(mutant, ref.one->name)) continue;
      const bool speaks = !mutant.requirements.empty() && speaks_of(*ref.one, mutant);
      if (speaks == first && judge(ref, mutant, found)) return found;
    }
  }
  return found;
}

std::vector<Found> hunt_all(const Golden& golden, const Mutants& mutants, unsigned threads) {
  std::vector<Found> found(mutants.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < mutants.size(); i = next++) {
      found[i] = hunt(golden, mutants[i]);
    }
  };
  std::vector<std::thread> others;
  for (unsigned i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  return found;
}

}  // namespace rubric::mutants
