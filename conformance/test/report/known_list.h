// Writes files of expected failures, for people to complete with their reasons.
#pragma once

#include <string>

#include "conformance/report/known_failures.h"
#include "conformance/test/suite/cases.h"

namespace rubric::suite {

/// Returns a list of all that keeps a run from being as expected: each line that was not kept, and
/// the cases that were not decided, by what was missing. Reasons are those of `known` where it has
/// them, and else empty, which `rubric test --expect` refuses.
std::string known_list(const SuiteRun& run, const report::KnownFailures& known);

/// Returns the list for an adapter of one role that can do nothing yet but get_clock(): its cases
/// with any other call, by the first such call.
std::string list_to_begin_with(const Cases& cases, machine::Role role);

}  // namespace rubric::suite
