#include "conformance/test/suite/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <iterator>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "conformance/test/runner/expectation.h"
#include "conformance/test/suite/canary.h"
#include "conformance/test/suite/causes.h"
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

// Returns the channel access with which a node that fails and states none passes; 0 if there is no
// such, or in real time, where finding out takes as long again.
runner::Ticks passing_access(const trace::File& head, const trace::Case& one,
                             targets::Attachment& attachment) {
  const targets::Identity& who = attachment.identity();
  constexpr trace::ParameterId kId = trace::ParameterId::kChannelAccess;
  if (!trace::protocol().has_machine || who.real_time || find(who.stated, kId)) return 0;
  if (!runner::uses(one, kId)) return 0;
  const runner::Ticks access = runner::profile_of(trace::scope_of(head, one)).early_ticks;
  const runner::CaseResult again = runner::run_case(
      head, one, [&](const trace::NodeHeader&) { return attachment.target(); }, access);
  return again.verdict == CaseVerdict::kPass ? access : 0;
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
      std::string when = one.broke ? "after its last case" : "after `bye`";
      if (before < run_.cases.size()) {
        when = "before " + plan_.cases[before / plan_.repeats].one->name;
      } else if (one.open != ReqId::kNone) {
        when = "from its first case to its last";
      }
      mishaps_.push_back({before,
                          {std::move(when), std::move(one.text), one.broke,
                           std::move(one.stderr_text), one.open}});
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

}  // namespace

CaseRun run_one(const SuiteCase& one, targets::Attachment& attachment, const std::string& profile,
                std::optional<std::uint64_t> seed) {
  CaseRun out = one.blank();
  const auto start = Clock::now();
  out.result.name = out.name;
  std::string text;  // Its standard error.
  trace::File head;  // One case as a file.
  head.head = one.file->file.head;
  trace::Case itself = one.whole();
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
      if (out.result.verdict == CaseVerdict::kFail) {
        compare_with_machine(head, itself, out);
        text = attachment.take_stderr();
        const auto& failures = out.result.failures;
        if (std::ranges::none_of(failures, [](const auto& failure) { return failure.crash; })) {
          out.channel_access = passing_access(head, itself, attachment);
        }
        attachment.take_stderr();
      }
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
  text += attachment.take_stderr();
  const bool wrong =
      out.result.verdict == CaseVerdict::kFail || out.result.verdict == CaseVerdict::kError;
  if (wrong) out.stderr_text = std::move(text);
  out.wall_ms = ms_since(start);
  return out;
}

ImplementationRun run(const std::string& target, const MakeAttachment& make, const Plan& plan,
                      const Watcher& watcher) {
  const auto start = Clock::now();
  ImplementationRun out{.target = target};
  const std::unique_ptr<targets::Attachment> first = make();
  out.dishonest = dishonesty(*first, plan.seed);
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
  find_causes(out);
  out.outside = plan_run.outside();
  out.wall_ms = ms_since(start);
  return out;
}

}  // namespace rubric::suite
