// A run of the suite for people, piece by piece as it goes.
#pragma once

#include <string>

#include "conformance/report/text.h"
#include "conformance/suite/report/json.h"
#include "conformance/suite/result.h"

namespace rubric::suite {

struct TextOptions : report::TextStyle {
  bool quiet = false;    ///< Only what makes the run fail has a line.
  bool verbose = false;  ///< Each failure in full, not the first of each rule alone.
  bool times = false;    ///< Says how long it took. Without, the same run gives the same text.
};

/// Who is tested, and with how many cases; or why nothing is.
std::string opening_text(const SuiteRun& run, const ImplementationRun& implementation,
                         std::size_t cases, const TextOptions& options);
/// A line: verdict, name, and what is wrong. Empty where `quiet` leaves it out.
std::string case_text(const CaseRun& one, const TextOptions& options);
/// Failures and errors in full, others of the same rule in a line each; what was skipped and not
/// decided, by reason.
std::string story_text(const SuiteRun& run, const ImplementationRun& implementation,
                       const TextOptions& options);
/// Counts, rules and times of an implementation.
std::string totals_text(const ImplementationRun& implementation, const TextOptions& options);
/// Cases whose verdict is another than in an earlier run, that it does not have, and that are gone
/// since; `name` is what the user calls that run.
std::string changes_text(const SuiteRun& run, const EarlierRun& earlier, const std::string& name,
                         const TextOptions& options);
/// Expectations that are not true, and how the run ends.
std::string closing_text(const SuiteRun& run, const TextOptions& options);

}  // namespace rubric::suite
