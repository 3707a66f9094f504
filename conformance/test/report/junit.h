// A run of the suite in JUnit's XML.
#pragma once

#include <string>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Returns one testsuite for each implementation, one testcase for each case, with unique names.
std::string junit_report(const SuiteRun& run);

}  // namespace rubric::suite
