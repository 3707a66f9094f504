// A report for programs: schema rubric.check/1, see tools/check_format.md.
#pragma once

#include "conformance/oracle/report/text.h"
#include "conformance/report/json.h"

namespace rubric::report {

Json json_report(const Story& story);

/// One object of its `findings`.
Json json_finding(const Story& story, std::size_t index);

}  // namespace rubric::report
