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

/// Exit codes of the subcommands that give verdicts: check, explore, coverage.
enum VerdictCode : int {
  kVerdictExpected = 0,      ///< Everything is as expected.
  kVerdictFailed = 1,        ///< An unexpected failure, or an expectation that does not hold.
  kVerdictBroken = 2,        ///< The kit itself broke.
  kVerdictInconclusive = 3,  ///< Nothing could be decided.
  kVerdictUsage = 64,        ///< The command line or the expectation file makes no sense.
  kVerdictInput = 66,        ///< Input cannot be read.
};

/// Ends the subcommand, from within its callback, with this code.
[[noreturn]] void exit_with(int code);

}  // namespace rubric::cli
