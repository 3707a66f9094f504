// rubric decode: prints the contents of captures.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_decode(CLI::App& app);

}  // namespace rubric::tools
