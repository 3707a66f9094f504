// Annotations for the log of a GitHub Actions job.
#pragma once

#include <string>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// `::error` lines for the gravest unexpected results, at most `max` of them, each at its line of
/// the golden trace.
std::string github_annotations(const SuiteRun& run, std::size_t max = 10);

}  // namespace rubric::suite
