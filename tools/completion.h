// rubric completion: what a shell needs to complete the command line, from the options themselves.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand. The others have to be there when it runs.
void add_completion(CLI::App& app);

}  // namespace rubric::tools
