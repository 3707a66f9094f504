// Parses the command line, runs the subcommand, and says what is wrong with a bad one.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::cli {

/// What a bad command line of this subcommand exits with; kExitUsage where nothing is set.
void set_usage_exit_code(const CLI::App& command, int code);

/// The program's exit code. Mistakes go to stderr, with the nearest subcommand or option.
int parse_and_run(CLI::App& app, int argc, char** argv);

}  // namespace rubric::cli
