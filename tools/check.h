// rubric check: holds captures and logs against the protocol's rules.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_check(CLI::App& app);

}  // namespace rubric::tools
