// Small judgements on the lines of a case.
#pragma once

#include "conformance/test/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Converts a time of a trace to ticks of the machine, 1024 to the second.
Ticks ticks_of(trace::Tick unit, std::int64_t time);
/// Returns whether breaking this line is weak: it names rules, and all of them are SHOULD.
bool is_weak(const trace::Line& line);

}  // namespace rubric::runner
