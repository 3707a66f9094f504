// `rubric check` of a growing run: lines in use and files that grow.
#pragma once

#include "tools/commands/check_options.h"

namespace rubric::tools {

/// Returns whether some source of the run has no end of its own.
bool is_live(const CheckOptions& options);

/// Reports findings as they come, and at the end all of them. Returns the exit code. Throws
/// cli::UsageError if options make no sense for such a run.
int check_live(const CheckOptions& options);

}  // namespace rubric::tools
