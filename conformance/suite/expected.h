// The file of expected failures: what an implementation is known to do otherwise, and why.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "conformance/suite/cases.h"

namespace rubric::suite {

struct ExpectedFailure {
  std::string cases;        ///< A name, or a glob: each of them fails so.
  std::string requirement;  ///< That the failing line names: "J4-SEQ", "J4"; or "none".
  std::string message;      ///< Part of the line that is not kept, or of what happened instead.
  std::string reason;
  std::string target;       ///< A glob for the target or the implementation's name; empty: any.
  std::string profile;      ///< "paper" or "deployed"; empty: any.
  std::uint32_t line = 0;   ///< Where it stands in its file.
};

struct ExpectedFailures {
  std::string name;  ///< Of the file.
  std::vector<ExpectedFailure> entries;
};

/// A YAML list of maps with case, requirement, message, reason, and perhaps target and profile.
/// Throws std::runtime_error with "file:line: what".
ExpectedFailures parse_expected(std::string_view text, const std::string& name);

/// Sets the expectation of a case that was worked. Failures are expected that an entry has, or that
/// break only rules in which the case's profile accepts a difference, or lines that the reference
/// machine breaks as well when it plays that profile. `implementation` needs target
/// and identity.
void expect(const ExpectedFailures& expected, const ImplementationRun& implementation,
            CaseRun& one);

/// Entries that are not true of the run, each once: that name no case at all, or of whose cases
/// some were worked and passed, or failed otherwise. Nothing is said of entries for another target
/// or profile, nor of cases that were not worked to their end.
std::vector<StaleExpectation> untrue(const ExpectedFailures& expected, const SuiteRun& run,
                                     const Cases& all);

}  // namespace rubric::suite
