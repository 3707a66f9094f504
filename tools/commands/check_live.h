// `rubric check` of a run that goes on: lines in use and files that grow.
#pragma once

#include "tools/commands/check_options.h"

namespace rubric::tools {

/// Whether some source of the run has no end of its own.
bool is_live(const CheckOptions& options);

/// Tells findings as they come, and at the end reports all of them. Returns the exit code. Throws
/// cli::UsageError where options make no sense for such a run.
int check_live(const CheckOptions& options);

}  // namespace rubric::tools
