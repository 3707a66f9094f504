// Words that every report of a suite shares.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

inline constexpr std::array kVerdicts = {
    runner::CaseVerdict::kPass, runner::CaseVerdict::kWeak,  runner::CaseVerdict::kInconclusive,
    runner::CaseVerdict::kFail, runner::CaseVerdict::kError, runner::CaseVerdict::kSkip};

/// Returns "mote", "sink", "base_station".
std::string_view role_text(machine::Role role);
/// Returns "none", "as_expected", "otherwise", "unexpected_pass"; stable, as programs read them.
std::string_view expectation_text(Expectation expectation);

/// Returns "mote 1.0": unique among the implementations of a run, with a number after it if needed.
std::string implementation_name(const SuiteRun& run, std::size_t index);
/// Returns "j4.accept", and "j4.accept#2" for a repeated case.
std::string case_name(const CaseRun& one);
/// Returns whether it is inconclusive since the target shows a part of its node only.
bool is_beyond_reach(const CaseRun& one);
/// Returns why an error is one, without the command that was asked then.
std::string what_broke(const CaseRun& one);
/// Returns one line: the first failure, or why there is no verdict.
std::string headline(const CaseRun& one);
/// Returns rules with their sentences, the lines that were not kept, what happened instead, and the
/// standard error of a broken target.
std::string in_full(const CaseRun& one);
/// Returns why a run is incomplete although none of its cases says so: nothing was decided, a rule
/// was left open, or too few were decided. Mostly empty.
std::string incomplete_as_a_whole(const SuiteRun& run, const ImplementationRun& implementation);
/// Returns whether it died or wrote something outside of the cases.
bool broke_outside(const ImplementationRun& implementation);
/// Returns "was killed by signal 9 (Killed), before j1.request".
std::string outside_text(const OutsideFault& fault);
/// Returns one line: the gravest of these, and the number of others; empty if there are none.
std::string outside_headline(const ImplementationRun& implementation);
/// Returns sentences on what would decide more, or let more pass, each once for all its cases:
/// links that are not shown, and a radio's channel access that is not stated.
std::vector<std::string> advice(const ImplementationRun& implementation);
/// Returns the command that runs just this case again.
std::string replay_command(const SuiteRun& run, const ImplementationRun& implementation,
                           const CaseRun& one);

/// Returns why a case is not decided, without times and arguments: "call join: no such call" for
/// "`call 0 join(type=1)`: no such call".
std::string what_was_missing(const std::string& reason);

}  // namespace rubric::suite
