// rubric explore: visits every state of a small network and checks its properties.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_explore(CLI::App& app);

}  // namespace rubric::tools
