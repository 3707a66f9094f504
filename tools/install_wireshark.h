// rubric install-wireshark: installs the dissector and rubric-extcap where Wireshark finds them.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::tools {

/// Adds the subcommand.
void add_install_wireshark(CLI::App& app);

}  // namespace rubric::tools
