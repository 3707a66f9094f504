// rubric generate: makes valid and near-valid frames with the results that a decoder must give.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_generate(CLI::App& app);

}  // namespace rubric::tools
