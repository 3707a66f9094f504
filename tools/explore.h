// rubric explore: every state of a small network, and what must hold in all of them.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_explore(CLI::App& app);

}  // namespace rubric::tools
