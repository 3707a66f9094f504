// A report for those who collect JUnit's XML.
#pragma once

#include <string>

#include "conformance/oracle/report/text.h"

namespace rubric::report {

/// One testsuite; a testcase for each rule that was exercised or found broken, and for each
/// expectation that is not true any more.
std::string junit_report(const Story& story);

}  // namespace rubric::report
