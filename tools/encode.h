// rubric encode: frames from the lines that rubric decode prints, or from fields alone.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_encode(CLI::App& app);

}  // namespace rubric::tools
