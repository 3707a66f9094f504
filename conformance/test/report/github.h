// Annotations for the log of a GitHub Actions job.
#pragma once

#include <string>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Returns at most `max` `::error` lines: refused implementations, expectations that do not hold,
/// and the gravest unexpected results, each at its line of the golden trace.
std::string github_annotations(const SuiteRun& run, std::size_t max = 10);

}  // namespace rubric::suite
