// Exit codes of all subcommands. The book's page "Exit codes and formats" says them to users.
#pragma once

namespace rubric::cli {

enum ExitCode : int {
  kExitClean = 0,       ///< Done, and all is as it should be.
  kExitFindings = 1,    ///< Done, and something was found: malformed, failed, different.
  kExitBroken = 2,      ///< The kit, or an implementation under test, broke.
  kExitIncomplete = 3,  ///< Not all was done: nothing was decided, or a packet was not confirmed.
  kExitUsage = 64,      ///< The command line or an expectation file makes no sense; EX_USAGE.
  kExitInput = 66,      ///< Input cannot be had or read; EX_NOINPUT of sysexits.h.
  kExitOutput = 74,     ///< Output cannot be written: a full disk, a closed pipe; EX_IOERR.
};

class Ending;
/// Returns the code that exit_with() ended a subcommand with; -1 for another ending.
int code_of(const Ending& ending);

/// Ends the subcommand, from within its callback, with this code.
[[noreturn]] void exit_with(int code);

}  // namespace rubric::cli
