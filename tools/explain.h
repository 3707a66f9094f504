// rubric explain: explains a message, a rule, a name or a frame, from the tables.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_explain(CLI::App& app);

}  // namespace rubric::tools
