// rubric convert: packets from one container into another.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_convert(CLI::App& app);

}  // namespace rubric::tools
