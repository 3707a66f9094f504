// A report for programs: schema rubric.check/1, see tools/check_format.md.
#pragma once

#include <string>

#include "conformance/oracle/report/text.h"

namespace rubric::report {

/// One JSON object and a line end.
std::string json_report(const Story& story);

}  // namespace rubric::report
