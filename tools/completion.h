// rubric completion: prints a shell's completion script, made from the options themselves.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand. The others must exist when it runs.
void add_completion(CLI::App& app);

}  // namespace rubric::tools
