// rubric simulate: runs a network in virtual time, and writes log and capture.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_simulate(CLI::App& app);

}  // namespace rubric::tools
