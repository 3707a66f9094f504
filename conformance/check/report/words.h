// Words that every form of the checker's report shares.
#pragma once

#include <string>
#include <string_view>

#include "codec/text/text.h"
#include "conformance/check/finding.h"
#include "conformance/check/observation.h"

namespace rubric::report {

/// Returns "fail", "weak", "stray", "inconclusive", "note"; stable, as programs read them.
std::string_view severity_name(check::Severity severity);
/// Returns "pass", "weak", "stray", "inconclusive", "fail".
std::string_view verdict_name(check::Verdict verdict);

/// Returns "frame 12 at 3.842100 s", "frame 12 of b.pcapng at ..." in a run of several files, "the
/// end of the run" if no frame is meant.
std::string place_text(const check::Run& run, const check::Place& place);
/// Returns the id of a rule; "(no rule)" for a finding by none.
std::string_view rule_text(ReqId id);
/// Returns "J4-SEQ, mote 5, frame 12 at 3.842100 s", without a node where none is known.
std::string heading_text(const check::Run& run, const check::Finding& finding);
}  // namespace rubric::report
