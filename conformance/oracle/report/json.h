// A report for programs: schema rubric.check/1, see tools/check_format.md.
#pragma once

#include <string>

#include "conformance/oracle/report/text.h"

namespace rubric::report {

/// Returns one JSON object and a line end.
std::string json_report(const Story& story);

/// Returns one object of its `findings`, without a line end.
std::string json_finding(const Story& story, std::size_t index);

}  // namespace rubric::report
