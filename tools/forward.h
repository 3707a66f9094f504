// rubric forward: shares a serial line, or a serial forwarder, with many clients.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_forward(CLI::App& app);

}  // namespace rubric::tools
