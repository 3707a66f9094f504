// A run of the suite as Test Anything Protocol, version 13.
#pragma once

#include <string>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Returns a test point for each case of each implementation, failures with a YAML block; expected
/// failures are "# TODO", skipped and undecided cases "# SKIP".
std::string tap_report(const SuiteRun& run);

}  // namespace rubric::suite
