// A report in JUnit's XML.
#pragma once

#include <string>

#include "conformance/check/report/text.h"

namespace rubric::report {

/// Returns one testsuite, with a testcase for each rule that was exercised or found broken, and for
/// each expectation that no longer holds.
std::string junit_report(const Story& story);

}  // namespace rubric::report
