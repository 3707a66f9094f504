// rubric stats: counts the contents of captures.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_stats(CLI::App& app);

}  // namespace rubric::tools
