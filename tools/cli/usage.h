// Parses the command line, runs the subcommand, and reports mistakes in it.
#pragma once

#include <CLI/CLI.hpp>

namespace rubric::cli {

/// Sets the exit code for a bad command line of this subcommand; kExitUsage by default.
void set_usage_exit_code(const CLI::App& command, int code);

/// Runs the program and returns its exit code. Prints mistakes on stderr, with the nearest
/// subcommand or option.
int parse_and_run(CLI::App& app, int argc, char** argv);

}  // namespace rubric::cli
