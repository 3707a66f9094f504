// Judgement of a run whose files are in order only as far as the frames tell that two of them have.
#pragma once

#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// Judges `run` with the frames of Run::loose at their likely times, as early and as late as they
/// can be, and without them, and with the lines of Run::slack_taps where they are, and later by
/// half of the slack and all of it. A failure, or what is weak, stands where it is found in each of
/// these orders; elsewhere it is inconclusive. What lies before the first common frame or behind
/// the last one must stand without the loose files, too, since nobody knows when they began and
/// ended.
Report judge_each_order(const Run& run, const Options& options);

}  // namespace rubric::oracle
