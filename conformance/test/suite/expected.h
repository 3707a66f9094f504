// The file of expected failures: where an implementation is known to differ, and why.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "conformance/report/known_failures.h"
#include "conformance/test/suite/cases.h"

namespace rubric::suite {

/// Reads a file's text as report::parse_known_failures() does.
report::KnownFailures parse_expected(std::string_view text, const std::string& name);

/// Sets the expectation of a case that was worked. Failures are expected that an entry has, or that
/// break only rules in which the case's profile accepts a difference, or lines that the reference
/// machine breaks as well when it plays that profile. `implementation` needs target
/// and identity.
void expect(const report::KnownFailures& expected, const ImplementationRun& implementation,
            CaseRun& one);

/// Entries that are not true of the run, each once: that name no case at all, or of whose cases
/// some were worked and passed, or failed otherwise. Nothing is said of entries for another target
/// or profile, nor of cases that were not worked to their end.
std::vector<StaleExpectation> untrue(const report::KnownFailures& expected, const SuiteRun& run,
                                     const Cases& all);

}  // namespace rubric::suite
