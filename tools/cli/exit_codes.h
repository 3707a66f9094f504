// Exit codes of all subcommands.
#pragma once

namespace rubric::cli {

/// The program's exit codes; the greatest that applies is returned.
enum ExitCode : int {
  kExitClean = 0,      ///< Nothing is wrong with what was read.
  kExitMalformed = 1,  ///< Something malformed was found; with --strict, also something noted.
  kExitUsage = 2,      ///< The command line makes no sense.
  kExitInput = 3,      ///< Input cannot be read.
  kExitNotSent = 4,    ///< send: a packet was not confirmed, or the line cannot be had or is gone.
};

/// Output could not be written: a full disk, a closed pipe, a folder that is gone. EX_IOERR of
/// sysexits.h, the same for all subcommands.
constexpr int kExitOutput = 74;
/// There was not even memory to read the command line. EX_OSERR.
constexpr int kExitSystem = 71;

/// Exit codes of the subcommands that give verdicts: check, explore, coverage.
enum VerdictCode : int {
  kVerdictExpected = 0,      ///< Everything is as expected.
  kVerdictFailed = 1,        ///< An unexpected failure, or an expectation that does not hold.
  kVerdictBroken = 2,        ///< The kit itself broke.
  kVerdictInconclusive = 3,  ///< Nothing could be decided.
  kVerdictUsage = 64,        ///< The command line or the expectation file makes no sense.
  kVerdictInput = 66,        ///< Input cannot be read.
};

class Ending;
/// Returns the code that exit_with() ended a subcommand with; -1 for another ending.
int code_of(const Ending& ending);

/// Ends the subcommand, from within its callback, with this code.
[[noreturn]] void exit_with(int code);

}  // namespace rubric::cli
