// How every subcommand ends.
#pragma once

namespace rubric::cli {

/// The program's exit codes; the greatest that applies is returned.
enum ExitCode : int {
  kExitClean = 0,      ///< Nothing is wrong with what was read.
  kExitMalformed = 1,  ///< Something malformed was found; with --strict, also something noted.
  kExitUsage = 2,      ///< The command line makes no sense.
  kExitInput = 3,      ///< Input cannot be read or output cannot be written.
};

/// Ends the subcommand, from within its callback, with this code.
[[noreturn]] void exit_with(int code);

}  // namespace rubric::cli
