// The file of expected failures: where an implementation is known to differ, and why.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/report/known_failures.h"
#include "conformance/test/suite/cases.h"

namespace rubric::suite {

/// Reads a file's text as report::parse_known_failures() does.
report::KnownFailures parse_expected(std::string_view text, const std::string& name);

/// Sets the expectation of a case that was worked; one that was not decided is no longer owed if an
/// entry lists it as skipped. Failures are expected that an entry has, or that
/// break only rules in which the case's profile accepts a difference, or lines that the reference
/// machine breaks as well when it plays that profile. `implementation` needs target
/// and identity.
void expect(const report::KnownFailures& expected, const ImplementationRun& implementation,
            CaseRun& one);

/// Returns the reason of the entry that has this failure of a case, or nothing.
std::optional<std::string> reason_of(const report::KnownFailures& expected,
                                     const ImplementationRun& implementation, const CaseRun& one,
                                     const runner::Failure& failure);

/// Entries that are not true of the run, each once: that name no case at all, of whose cases some
/// were worked and passed, or failed otherwise, or whose skipped cases were all decided. Nothing is
/// said of entries for another target or profile, nor of failures in cases that were not worked to
/// their end, nor of cases for a role that the implementation does not play.
std::vector<StaleExpectation> untrue(const report::KnownFailures& expected, const SuiteRun& run,
                                     const Cases& all);

}  // namespace rubric::suite
