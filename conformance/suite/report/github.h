// Annotations for the log of a GitHub Actions job.
#pragma once

#include <string>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// At most `max` `::error` lines: implementations that are refused, expectations that are not true,
/// and the gravest unexpected results, each at its line of the golden trace.
std::string github_annotations(const SuiteRun& run, std::size_t max = 10);

}  // namespace rubric::suite
