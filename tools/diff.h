// rubric diff: finds the shortest trace on which two implementations, or two profiles, differ.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_diff(CLI::App& app);

}  // namespace rubric::tools
