// Small judgements on the lines of a case.
#pragma once

#include "conformance/test/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::runner {

/// A span of time with both ends included.
struct Window {
  Ticks from = 0;
  Ticks to = 0;
  bool holds(Ticks time) const { return from <= time && time <= to; }
};

/// Converts a time of a trace to ticks of the machine, 1024 to the second.
Ticks ticks_of(trace::Tick unit, std::int64_t time);
/// Returns whether breaking this line is weak: it names rules, and all of them are SHOULD.
bool is_weak(const trace::Line& line);

}  // namespace rubric::runner
