// The same air or the same serial line in two files of a run.
#pragma once

#include <string>

#include "conformance/check/observation.h"

namespace rubric::check {

/// Keeps frames that two files share only once. Two captures of the air at the same time show the
/// same frames, within the skew of their clocks, or one has all frames of the other: then that one
/// counts, and Run::facts says so. The same holds for a serial line, and for a file without stamps
/// that has a part of another's frames in their order. Frames of a log give way to a capture that
/// shows that link at the time. Returns false, with `error`, if two files are of the same air or
/// line and disagree, if a file of the air has no stamps and fits nowhere, or if two logs have one
/// node.
bool drop_duplicates(Run& run, const Options& options, std::string& error);

}  // namespace rubric::check
