// Judgement of a run whose files are in order only as far as the frames tell that two of them have.
#pragma once

#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// Judges `run` with the frames of Run::loose at their likely times, as early and as late as they
/// can be, and without them. A failure, or what is weak, stands where it is found in each of these
/// orders; elsewhere it is inconclusive. What lies before the first common frame or behind the last
/// one must stand without those files, too, since nobody knows when they began and ended.
Report judge_each_order(const Run& run, const Options& options);

}  // namespace rubric::oracle
