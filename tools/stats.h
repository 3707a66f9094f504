// rubric stats: what captures hold, counted.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_stats(CLI::App& app);

}  // namespace rubric::tools
