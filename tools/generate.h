// rubric generate: valid and near-valid frames with what a decoder must say of each.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_generate(CLI::App& app);

}  // namespace rubric::tools
