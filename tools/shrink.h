// rubric shrink: makes a failing trace as small as possible.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_shrink(CLI::App& app);

}  // namespace rubric::tools
