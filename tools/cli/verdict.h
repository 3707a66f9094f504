// What the subcommands that give verdicts have in common.
#pragma once

#include <functional>
#include <string>

#include "tools/cli/command.h"

namespace rubric::cli {

/// Has the subcommand end with what `run` returns, one of VerdictCode. What that throws, but for
/// Ending, is printed, and the kit broke.
void set_verdict(Command& command, std::function<int()> run);

/// Ends the subcommand: its input cannot be read. `what` may be a list of lines.
[[noreturn]] void unreadable(const char* command, std::string what);
/// The whole of a file, or of stdin for "-"; ends the subcommand where that cannot be read.
std::string text_of_file(const char* command, const std::string& path);

}  // namespace rubric::cli
