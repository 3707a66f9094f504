// What a run of the suite found, as plain values: what all reports are made of.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "codec/generated/requirements.h"
#include "conformance/attach/attachment.h"
#include "conformance/runner/run_case.h"

namespace rubric::suite {

/// The other axis of a verdict: whether the file of expected failures has it.
enum class Expectation : std::uint8_t {
  kNone,           ///< The file does not speak of it.
  kAsExpected,     ///< It failed as the file says.
  kOtherwise,      ///< It failed, but with another rule or message.
  kUnexpectedPass, ///< It was to fail.
};

/// One case on one implementation.
struct CaseRun {
  std::string name;                    ///< "j4.accept".
  std::string file;                    ///< "conformance/cases/j4.rtr".
  std::string comment;                 ///< The mistake that it catches, as the file says it.
  std::vector<machine::Role> roles;    ///< Of its nodes under test.
  std::vector<ReqId> requirements;     ///< That its lines name, each once.
  std::uint32_t repeat = 0;            ///< Counted from 0 where --repeat asks for more than one.
  runner::CaseResult result;           ///< With failures and log.
  Expectation expectation = Expectation::kNone;
  std::string expected_reason;         ///< From the file.
  double wall_ms = 0;
  std::string stderr_text;             ///< Of the implementation while it broke.

  /// Neither pass nor expected: it makes the run fail.
  bool unexpected() const;
};

/// All cases on one implementation.
struct ImplementationRun {
  std::string target;         ///< As the user wrote it.
  attach::Identity identity;
  std::string dishonest;      ///< Why nothing else was run; mostly empty.
  std::vector<CaseRun> cases; ///< In the order of files and cases.
  double wall_ms = 0;
};

/// An entry of the file of expected failures that no case used, or that names what there is not.
struct StaleExpectation {
  std::string place;  ///< "file:line".
  std::string text;
};

struct SuiteRun {
  std::string profile = "paper";
  std::uint64_t seed = 0;
  std::string shard;          ///< "2/8", or empty.
  std::vector<ImplementationRun> implementations;
  std::vector<StaleExpectation> stale;
};

using VerdictCounts = std::map<runner::CaseVerdict, std::size_t>;
VerdictCounts count(const ImplementationRun& run);

/// How the cases of one rule went; for the summary of requirements.
struct RequirementSummary {
  ReqId requirement = ReqId::kNone;
  VerdictCounts cases;
  /// Cases with a failed line that names this rule.
  std::size_t broken = 0;
};
/// Of every rule that a case of the run names, in the catalogue's order.
std::vector<RequirementSummary> by_requirement(const ImplementationRun& run);

}  // namespace rubric::suite
