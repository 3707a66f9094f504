// Judges a run whose files are in order only as far as their common frames tell.
#pragma once

#include "conformance/check/observation.h"

namespace rubric::check {

/// Judges `run` with the frames of Run::loose at their likely times, as early and as late as they
/// can be, and without them, and with the lines of Run::slack_taps where they are, later by half of
/// the slack, and by all of it. A failure or a weak finding remains if each of these orders has it;
/// else it becomes inconclusive. Before the first common frame and after the last one it must be
/// found without the loose files too, since their beginning and end are unknown.
Report judge_each_order(const Run& run, const Options& options);

/// Judges `run`, a recorder's clock of which stepped, as if the frames after each step had come at
/// once, and as if they had come much later. What only one of the two has is inconclusive.
Report judge_each_gap(const Run& run, const Options& options);

}  // namespace rubric::check
