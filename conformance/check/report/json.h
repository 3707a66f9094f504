// A report for programs: schema rubric.check/1, see tools/commands/check_format.md.
#pragma once

#include "codec/text/json.h"
#include "conformance/check/report/text.h"

namespace rubric::report {

text::Json json_report(const Story& story);

/// One object of its `findings`.
text::Json json_finding(const Story& story, std::size_t index);

}  // namespace rubric::report
