// The width of text, and the height of a screen.
#pragma once

#include <cstddef>

#include "tools/cli/command.h"

namespace rubric::cli {

/// Says once that stdin is read, where it is a terminal: before a command reads it.
void say_what_is_awaited();

/// Adds --width for what columns() is asked.
void add_width_option(Command& command, std::size_t& asked);
/// Returns `asked` if it is not 0; else the width of the terminal that `fd` is, between 60 and 120;
/// else 100.
std::size_t columns(std::size_t asked, int fd);
/// Returns the width of the terminal that `fd` is, 0 if it is none.
std::size_t screen_columns(int fd);
/// Returns how many lines the terminal that `fd` is shows, at least 10; 24 if it does not say.
std::size_t rows(int fd);

}  // namespace rubric::cli
