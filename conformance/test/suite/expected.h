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

/// Sets the expectation of a case that was run; one that was not decided is no longer owed if an
/// entry lists it as skipped. Failures are expected that an entry has, or that break only rules in
/// which the case's profile accepts a difference, or lines that the reference machine breaks as
/// well when it plays that profile. `implementation` needs target and identity.
void expect(const report::KnownFailures& expected, const ImplementationRun& implementation,
            CaseRun& one);

/// Returns the reason of the entry that has this failure of a case, or nothing.
std::optional<std::string> reason_of(const report::KnownFailures& expected,
                                     const ImplementationRun& implementation, const CaseRun& one,
                                     const runner::Failure& failure);

/// Returns the entries that do not hold, each once: those that name no case, those of whose cases
/// some passed or failed otherwise, and those whose skipped cases were all decided. Leaves out
/// entries for another target or profile, failures in cases that were not run to their end, and
/// cases for a role that the implementation does not play.
std::vector<StaleExpectation> stale_expectations(const report::KnownFailures& expected,
                                                 const SuiteRun& run, const Cases& all);

}  // namespace rubric::suite
