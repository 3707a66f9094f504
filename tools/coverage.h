// rubric coverage: lists which rules the golden traces, the machine, the explorer and the mutants
// touch.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_coverage(CLI::App& app);

}  // namespace rubric::tools
