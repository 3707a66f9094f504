// rubric repro: prints an input of the stateful fuzz targets as a trace.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

void add_repro(CLI::App& app);

}  // namespace rubric::tools
