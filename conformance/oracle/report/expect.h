// Expectation files: known failures, each with the reason why it is known.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/oracle/observation.h"

namespace rubric::report {

/// A known failure. Empty texts match anything, but message and reason are required.
struct Expectation {
  ReqId requirement = ReqId::kNone;
  std::string node;     ///< The finding's node, exactly.
  std::string file;     ///< A glob that the file's path or name matches.
  std::string profile;  ///< "paper" or "deployed": holds under that one only.
  std::string message;  ///< Part of the finding's text.
  std::string reason;
  std::uint32_t line = 0;  ///< Line number in its file.
};

struct ExpectationFile {
  std::string name;
  std::vector<Expectation> expectations;
};

/// The outcome of an expectation.
enum class Came : std::uint8_t {
  kTrue,          ///< A failure is just so.
  kStale,         ///< Nothing failed that way any more.
  kOtherMessage,  ///< It fails, but says something else.
  kNotAsked,      ///< It is about another file or profile.
};
/// Returns "matched", "stale", "other_message", "not_applicable".
std::string_view came_name(Came came);

struct ExpectationResult {
  Came came = Came::kNotAsked;
  std::vector<std::size_t> findings;  ///< Those that match; with kOtherMessage those that do not.
};

constexpr std::size_t kUnexpected = static_cast<std::size_t>(-1);

/// A report compared with its expectations.
struct Outcome {
  std::vector<ExpectationResult> results;  ///< One for each expectation.
  std::vector<std::size_t> expected_by;    ///< One for each finding; kUnexpected: by none.
  std::uint64_t unexpected_failures = 0;
  std::uint64_t broken_expectations = 0;   ///< Stale, or with another message.
  bool nothing_judged = false;             ///< No rule had its chance to be broken.
  /// The report's verdict; inconclusive if nothing could be judged.
  oracle::Verdict verdict = oracle::Verdict::kPass;

  bool as_expected() const { return unexpected_failures == 0 && broken_expectations == 0; }
  /// Returns 0 as expected, 1 not, 3 nothing but inconclusive.
  int exit_code() const { return !as_expected() ? 1 : nothing_judged ? 3 : 0; }
};

/// Reads a file's text. Returns false, with `error` as "file:line: what", if it makes no sense.
bool parse_expectations(std::string_view text, const std::string& name, ExpectationFile& out,
                        std::string& error);

Outcome compare(const oracle::Run& run, const oracle::Options& options,
                const oracle::Report& report, const ExpectationFile& file);

}  // namespace rubric::report
