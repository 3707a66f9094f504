// The same air or the same serial line in two files of a run.
#pragma once

#include <string>

#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// Keeps once what two files both have. Two captures of the air at the same time show the same
/// frames, within the skew of their clocks, or one of them all of the other's: then that one
/// counts, and Run::facts says so; likewise a serial line, and a file without stamps that has a
/// part of another's frames in their order. False, with `error`, where two files are of the same
/// air or line and disagree, where a file of the air has no stamps and belongs nowhere, or where a
/// log has frames as well as a capture, or a node that another log has.
bool drop_duplicates(Run& run, const Options& options, std::string& error);

}  // namespace rubric::oracle
