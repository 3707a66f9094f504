// rubric shrink: a failing trace made as small as it can be.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_shrink(CLI::App& app);

}  // namespace rubric::tools
