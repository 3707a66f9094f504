// The file of expected failures: where an implementation is known to differ, and why.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "conformance/suite/cases.h"

namespace rubric::suite {

struct ExpectedFailure {
  std::string cases;        ///< A name, or a glob: each of them fails so.
  std::string requirement;  ///< In the failing line: "J4-SEQ", "J4"; or "none".
  std::string message;      ///< Part of the line that is not kept, or of what happened instead.
  std::string reason;
  std::string target;       ///< A glob for the target or the implementation's name; empty: any.
  std::string profile;      ///< "paper" or "deployed"; empty: any.
  std::uint32_t line = 0;   ///< Line number in its file.
};

struct ExpectedFailures {
  std::string name;  ///< Name of the file.
  std::vector<ExpectedFailure> entries;
};

/// Parses a YAML list of maps with case, requirement, message, reason, and perhaps target and
/// profile. Throws std::runtime_error with "file:line: what".
ExpectedFailures parse_expected(std::string_view text, const std::string& name);

/// Sets the expectation of a case that was run. A failure is expected if an entry has it, or if it
/// breaks only rules in which the case's profile accepts a difference, or lines that the reference
/// machine breaks as well when it plays that profile. `implementation` needs target and identity.
void expect(const ExpectedFailures& expected, const ImplementationRun& implementation,
            CaseRun& one);

/// Returns the entries that do not hold for the run, each once: those that name no case at all, and
/// those some of whose cases passed or failed otherwise. Skips entries for another target or
/// profile, and cases that were not run to their end.
std::vector<StaleExpectation> untrue(const ExpectedFailures& expected, const SuiteRun& run,
                                     const Cases& all);

}  // namespace rubric::suite
