// Colour of output.
#pragma once

#include <string>

#include "tools/cli/command.h"

namespace rubric::cli {

/// Adds --color auto|always|never.
void add_color_option(Command& app, std::string& when);

/// Returns whether output to `fd` is coloured: with "auto" on a terminal, unless NO_COLOR is set
/// and not empty or TERM is dumb.
bool use_color(const std::string& when, int fd);

}  // namespace rubric::cli
