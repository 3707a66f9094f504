// rubric check: checks captures and logs by the protocol's rules.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_check(CLI::App& app);

}  // namespace rubric::tools
