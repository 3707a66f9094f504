// Compares a report with the failures that were expected of it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/check/observation.h"
#include "conformance/report/known_failures.h"

namespace rubric::report {

/// Whether an expectation holds.
enum class ExpectationState : std::uint8_t {
  kMatched,        ///< A failure is just so.
  kStale,          ///< Nothing failed that way any more.
  kOtherMessage,   ///< It fails, but says something else.
  kNotApplicable,  ///< It is about another file or profile, or inconclusive here.
};
/// Returns "matched", "stale", "other_message", "not_applicable".
std::string_view state_name(ExpectationState state);

struct ExpectationResult {
  ExpectationState state = ExpectationState::kNotApplicable;
  std::vector<std::size_t> findings;  ///< Those that match; with kOtherMessage those that do not.
};

constexpr std::size_t kUnexpected = static_cast<std::size_t>(-1);

/// A report compared with its expectations.
struct Outcome {
  std::vector<ExpectationResult> results;  ///< One for each expectation.
  std::vector<std::size_t> expected_by;    ///< One for each finding; kUnexpected: by none.
  std::uint64_t unexpected_failures = 0;
  std::uint64_t broken_expectations = 0;  ///< Stale, or with another message.
  bool nothing_judged = false;            ///< No rule had its chance to be broken.
  bool input_missing = false;             ///< A file is damaged or cut, or a source broke off.
  /// The report's verdict; inconclusive if nothing could be judged.
  check::Verdict verdict = check::Verdict::kPass;

  bool as_expected() const { return unexpected_failures == 0 && broken_expectations == 0; }
  /// Returns 0 as expected, 1 not, 3 nothing but inconclusive, 66 as expected in what there is.
  int exit_code() const {
    if (!as_expected()) return 1;
    if (input_missing) return 66;
    return nothing_judged ? 3 : 0;
  }
};

/// Reads a file's text as parse_known_failures() does.
KnownFailures parse_expectations(std::string_view text, const std::string& name);

Outcome compare(const check::Run& run, const check::Options& options, const check::Report& report,
                const KnownFailures& known);

}  // namespace rubric::report
