// rubric chart: a golden trace as a sequence chart, as the reference machine works it.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_chart(CLI::App& app);

}  // namespace rubric::tools
