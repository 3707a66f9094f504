// rubric simulate: a network in virtual time, written as log and capture.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_simulate(CLI::App& app);

}  // namespace rubric::tools
