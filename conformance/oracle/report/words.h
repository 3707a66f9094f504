// Words that every form of the oracle's report shares.
#pragma once

#include <string>
#include <string_view>

#include "conformance/oracle/finding.h"
#include "conformance/oracle/observation.h"
#include "conformance/report/text.h"

namespace rubric::report {

/// Returns "fail", "weak", "stray", "inconclusive", "note"; stable, as programs read them.
std::string_view severity_name(oracle::Severity severity);
/// Returns "pass", "weak", "stray", "inconclusive", "fail".
std::string_view verdict_name(oracle::Verdict verdict);

/// Returns "frame 12 at 3.842100 s", "frame 12 of b.pcapng at ..." in a run of several files, "the
/// end of the run" if no frame is meant.
std::string place_text(const oracle::Run& run, const oracle::Place& place);
}  // namespace rubric::report
