// Prints a run of the suite for people, piece by piece as it goes.
#pragma once

#include <string>

#include "codec/text/text.h"
#include "conformance/test/report/json.h"
#include "conformance/test/suite/result.h"

namespace rubric::suite {

struct TextOptions : text::TextStyle {
  bool quiet = false;    ///< Only what makes the run fail has a line.
  bool verbose = false;  ///< Each failure in full, not the first of each rule alone.
  bool cuts = true;      ///< A case's line ends at the width.
  bool times = false;    ///< Prints durations. Without, the same run gives the same text.
};

/// Returns the implementation and the number of cases; or why nothing is tested.
std::string opening_text(const SuiteRun& run, const ImplementationRun& implementation,
                         std::size_t cases, const TextOptions& options);
/// Returns a line: verdict, name, and fault. Empty if `quiet` leaves it out.
std::string case_text(const CaseRun& one, const TextOptions& options);
/// Returns failures and errors in full, others of the same rule on a line each; skipped and
/// undecided cases by reason.
std::string story_text(const SuiteRun& run, const ImplementationRun& implementation,
                       const TextOptions& options);
/// Returns counts, rules and times of an implementation, and why its run is incomplete.
std::string totals_text(const SuiteRun& run, const ImplementationRun& implementation,
                        const TextOptions& options);
/// Returns the cases whose verdict changed since an earlier run, that it lacks, and that are gone
/// since; `name` is the user's name for that run.
std::string changes_text(const SuiteRun& run, const EarlierRun& earlier, const std::string& name,
                         const TextOptions& options);
/// Returns expectations that do not hold, and the result of the run.
std::string closing_text(const SuiteRun& run, const TextOptions& options);

}  // namespace rubric::suite
