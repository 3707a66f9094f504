// rubric chart: draws a golden trace as a sequence chart, as run by the reference machine.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_chart(CLI::App& app);

}  // namespace rubric::tools
