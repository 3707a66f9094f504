// rubric send: sends packets to a mote's serial line in use, and shows its frames.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_send(CLI::App& app);

}  // namespace rubric::tools
