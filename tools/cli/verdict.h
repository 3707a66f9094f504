// The common part of subcommands that give verdicts.
#pragma once

#include <functional>
#include <string>

#include "tools/cli/command.h"

namespace rubric::cli {

/// Makes the subcommand end with the result of `run`, an ExitCode. An exception other than
/// Ending is printed, and means that the kit broke.
void set_verdict(Command& command, std::function<int()> run);

/// Ends the subcommand because its input cannot be read. `what` is a line without its end, or lines
/// with theirs, in which names have none.
[[noreturn]] void unreadable(const std::string& what);
/// Ends the command if the file is not there or may not be read.
void require_file(const std::string& path);
/// Returns a whole file, or stdin for "-"; ends the subcommand if that cannot be read.
std::string text_of_file(const std::string& path);

}  // namespace rubric::cli
