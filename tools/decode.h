// rubric decode: prints what captures hold.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_decode(CLI::App& app);

}  // namespace rubric::tools
