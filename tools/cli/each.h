// Many independent runs with one command: a line of result for each, several at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/cli/command.h"
#include "tools/cli/output.h"

namespace rubric::cli {

/// Filled by add_each_options.
struct EachOptions {
  bool each = false;
  std::uint64_t jobs = 0;  ///< 0: as many as there are cores.
  std::string resume;      ///< The file of what was done; empty: none.
  std::string shard;
};

/// Adds --each, --jobs, --resume and --shard.
void add_each_options(Command& command, EachOptions& options);
/// Throws UsageError if one of the others is given without --each.
void check_each(const EachOptions& options);

struct EachJob {
  const char* command = "";
  std::string settings;  ///< All that a result depends on besides the file.
  /// Makes what runs share, before the first of many.
  std::function<void()> prepare = [] {};
};

/// Does one run: puts what its line says into `members`, as members of a JSON object, and returns
/// its exit code. Where its process is killed, that is kExitBroken.
using EachRun = std::function<int(const std::string& file, std::string& members)>;

/// Does `run` with each file of `names`, which are files, folders (their captures and logs, at any
/// depth) and patterns, in a process of its own, and writes a line of JSON for each to the file
/// `out` in the order of their names. What a run prints on stderr becomes its line's "error".
/// Returns the exit code of the gravest.
int each(const EachOptions& options, const EachJob& job, const std::vector<std::string>& names,
         const std::string& out, const EachRun& run);

}  // namespace rubric::cli
