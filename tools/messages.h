// rubric messages: lists the messages of a protocol.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_messages(CLI::App& app);

}  // namespace rubric::tools
