// rubric test: runs golden traces on implementations.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_test(CLI::App& app);

}  // namespace rubric::tools
