#include "conformance/test/suite/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <iterator>
#include <map>
#include <mutex>
#include <new>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <utility>

#include "conformance/test/runner/subject_target.h"
#include "conformance/test/suite/canary.h"
#include "conformance/trace/headers.h"
#include "conformance/trace/protocol.h"

namespace rubric::suite {
namespace {

using Clock = std::chrono::steady_clock;
using runner::CaseVerdict;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Returns the role that a case needs for a node under test and that is missing; empty if none is.
std::string missing_role(const CaseRun& one, const targets::Identity& identity) {
  for (const machine::Role role : one.roles) {
    const auto& roles = identity.roles;
    if (std::find(roles.begin(), roles.end(), role) != roles.end()) continue;
    std::string plays;
    for (const machine::Role other : roles) {
      if (!plays.empty()) plays += " and ";
      plays += trace::role_text(static_cast<trace::Role>(other));
    }
    return fmt::format("it plays no {}, only {}", trace::role_text(static_cast<trace::Role>(role)),
                       plays);
  }
  return {};
}

// Runs the cases of a plan, each repeat by itself, on several attachments.
class PlanRun {
 public:
  PlanRun(const Plan& plan, const Watcher& watcher, ImplementationRun& run)
      : plan_(plan), watcher_(watcher), run_(run) {
    run_.cases.resize(plan.cases.size() * plan.repeats);
    done_.resize(run_.cases.size());
  }

  /// Keeps faults that happened when nothing was asked, noticed when case `before` was to begin.
  void keep_mishaps(targets::Attachment& attachment, std::size_t before) {
    for (targets::Mishap& one : attachment.take_mishaps()) {
      const char* const at_end = one.broke ? "after its last case" : "after `bye`";
      mishaps_.push_back(
          {before,
           {before < run_.cases.size() ? "before " + plan_.cases[before / plan_.repeats].blank.name
                                       : at_end,
            std::move(one.text), one.broke, std::move(one.stderr_text)}});
    }
  }

  /// Returns the faults of all attachments, after they are done.
  std::vector<OutsideFault> outside() {
    std::stable_sort(mishaps_.begin(), mishaps_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<OutsideFault> out;
    for (auto& [before, fault] : mishaps_) out.push_back(std::move(fault));
    return out;
  }

  /// Runs the next cases that nobody else runs, until none is left.
  void run_cases(targets::Attachment& attachment) {
    for (std::size_t i = next_++; i < run_.cases.size(); i = next_++) {
      const std::uint32_t repeat = static_cast<std::uint32_t>(i % plan_.repeats);
      std::optional<std::uint64_t> seed = plan_.seed;
      if (repeat > 0) seed = seed.value_or(0) + repeat;
      CaseRun one = run_one(plan_.cases[i / plan_.repeats], attachment, plan_.profile, seed);
      one.repeat = repeat;
      expect(plan_.expected, run_, one);
      const std::lock_guard lock(mutex_);
      keep_mishaps(attachment, i);
      run_.cases[i] = std::move(one);
      done_[i] = true;
      for (; reported_ < done_.size() && done_[reported_]; ++reported_) {
        if (watcher_.case_done) watcher_.case_done(run_.cases[reported_]);
      }
    }
    attachment.finish();
    const std::lock_guard lock(mutex_);
    keep_mishaps(attachment, run_.cases.size());
  }

 private:
  const Plan& plan_;
  const Watcher& watcher_;
  ImplementationRun& run_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::vector<bool> done_;
  std::vector<std::pair<std::size_t, OutsideFault>> mishaps_;
  std::size_t reported_ = 0;
};

// Whether it says no rule: a line of a set-up names none.
bool is_nameless(const runner::Failure& failure) {
  return failure.requirements.empty() && !failure.forbidden && !failure.crash;
}

// Gives nameless failures the rule by which the machine does what is missing; `right` is its run.
void blame_as_machine(const runner::CaseResult& right, const trace::Case& one,
                      std::vector<runner::Failure>& failures) {
  std::unordered_map<std::uint32_t, const trace::Line*> kept;  // By their places in the file.
  for (const trace::Line* line : one.lines()) kept.emplace(line->place.line, line);
  for (const runner::Failure& its : right.failures) kept.erase(its.place.line);
  // What it did by a rule, by node and message: the first of each time.
  std::map<std::pair<std::string_view, std::string_view>,
           std::map<std::int64_t, const trace::Line*>>
      by_rule;
  for (const trace::Line* did : right.log.lines()) {
    if (did->op != trace::Op::kEmits || did->requirements.empty()) continue;
    by_rule[{did->node, did->message.name}].emplace(did->time.from, did);
  }
  for (runner::Failure& failure : failures) {
    const auto line = kept.find(failure.place.line);
    if (!is_nameless(failure) || line == kept.end()) continue;
    const auto all = by_rule.find({failure.node, line->second->message.name});
    if (all == by_rule.end()) continue;
    const std::int64_t from = failure.from;
    auto nearest = all->second.lower_bound(from);
    if (nearest != all->second.begin()) {
      const auto before = std::prev(nearest);
      const bool nearer =
          nearest == all->second.end() || from - before->first <= nearest->first - from;
      if (nearer) nearest = before;
    }
    failure.requirements.assign(1, nearest->second->requirements.front());
  }
}

// Plays a case that failed with the machine, where its run says more: on which lines another
// profile has it fail, too, and what nameless failures broke.
void compare_with_machine(const trace::File& head, const trace::Case& one, CaseRun& out) {
  const bool other = out.profile != "paper";
  if (!trace::protocol().has_machine) return;
  if (!other && std::ranges::none_of(out.result.failures, is_nameless)) return;
  const runner::CaseResult right = runner::run_case(head, one, [](const trace::NodeHeader&) {
    return std::make_unique<runner::SubjectTarget>(std::make_unique<runner::Machine>());
  });
  for (const runner::Failure& failure : right.failures) {
    if (other) out.lines_of_profile.push_back(failure.place.line);
  }
  blame_as_machine(right, one, out.result.failures);
}

}  // namespace

CaseRun run_one(const SuiteCase& one, targets::Attachment& attachment, const std::string& profile,
                std::optional<std::uint64_t> seed) {
  CaseRun out = one.blank;
  const auto start = Clock::now();
  out.result.name = out.name;
  trace::File head;  // One case as a file.
  head.head = one.file->file.head;
  trace::Case itself = *one.one;
  if (!profile.empty()) {
    trace::set_header(head, itself, trace::ProfileHeader{profile});
    out.profile = profile;
  }
  if (seed && trace::set_seed_if_none(head, itself, *seed)) out.seed = *seed;
  try {
    std::string missing = missing_role(out, attachment.identity());
    if (missing.empty()) {
      const trace::Contradiction wrong = trace::state(head, itself, attachment.identity().stated);
      missing = wrong.text;
      out.ruled_out = wrong.stated;
    }
    out.nodes = trace::scope_of(head, itself).nodes;
    if (missing.empty()) {
      out.result = runner::run_case(head, itself,
                                    [&](const trace::NodeHeader&) { return attachment.target(); });
      out.foreign = out.result.not_built;
      if (out.result.verdict == CaseVerdict::kFail) compare_with_machine(head, itself, out);
    } else {
      out.result.verdict = CaseVerdict::kSkip;
      out.result.reason = missing;
      out.foreign = true;
    }
    const targets::Identity& who = attachment.identity();
    const bool owes = !who.own_line || out.result.damaged || out.result.refused;
    out.owed = out.undecided() && !out.foreign && owes;
    out.whole = !who.own_line && !who.shown && !who.real_time;
  } catch (const std::bad_alloc&) {
    throw;                                 // Says nothing of the target.
  } catch (const std::exception& error) {  // It did not start again.
    out.result.verdict = CaseVerdict::kError;
    out.result.reason = error.what();
  }
  std::string text = attachment.take_stderr();
  const bool wrong =
      out.result.verdict == CaseVerdict::kFail || out.result.verdict == CaseVerdict::kError;
  if (wrong) out.stderr_text = std::move(text);
  out.wall_ms = ms_since(start);
  return out;
}

ImplementationRun run(const std::string& target, const MakeAttachment& make, const Plan& plan,
                      const Watcher& watcher) {
  const auto start = Clock::now();
  ImplementationRun out;
  out.target = target;
  const std::unique_ptr<targets::Attachment> first = make();
  out.dishonest = dishonesty(*first);
  const std::string said = first->take_stderr();
  if (out.dishonest.empty()) {
    out.identity = first->identity();
  } else {
    out.stderr_text = said;
  }
  if (watcher.started) watcher.started(out);
  if (!out.dishonest.empty()) return out;
  PlanRun plan_run(plan, watcher, out);
  std::vector<std::thread> others;
  const unsigned jobs = out.identity.real_time ? 1 : plan.jobs;
  std::vector<std::exception_ptr> broken(jobs);  // Why a job stopped.
  for (unsigned i = 1; i < jobs; ++i) {
    others.emplace_back([&, i] {
      try {
        const std::unique_ptr<targets::Attachment> mine = make();
        plan_run.run_cases(*mine);
      } catch (...) {
        broken[i] = std::current_exception();
      }
    });
  }
  try {
    plan_run.run_cases(*first);
  } catch (...) {
    broken[0] = std::current_exception();
  }
  for (std::thread& one : others) one.join();
  for (const std::exception_ptr& one : broken) {
    if (one) std::rethrow_exception(one);
  }
  out.outside = plan_run.outside();
  out.wall_ms = ms_since(start);
  return out;
}

}  // namespace rubric::suite
