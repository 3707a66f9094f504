// A run of the suite for those who collect JUnit's XML.
#pragma once

#include <string>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// One testsuite for each implementation, one testcase for each case, names unique.
std::string junit_report(const SuiteRun& run);

}  // namespace rubric::suite
