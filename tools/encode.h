// rubric encode: makes frames from the lines of rubric decode, or from fields alone.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_encode(CLI::App& app);

}  // namespace rubric::tools
