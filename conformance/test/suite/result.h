// The results of a suite's run as plain values, from which all reports are made.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "codec/runtime/rule.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/targets/attachment.h"

namespace rubric::suite {

/// The other axis of a verdict: whether the file of expected failures has it.
enum class Expectation : std::uint8_t {
  kNone,            ///< The file does not speak of it.
  kAsExpected,      ///< It failed as the file says.
  kOtherwise,       ///< It failed, but with another rule or message.
  kUnexpectedPass,  ///< It was to fail.
};

/// One case on one implementation.
struct CaseRun {
  std::string name;                      ///< "j4.accept".
  std::string file;                      ///< "conformance/cases/j4.rtr".
  std::string comment;                   ///< The mistake that it catches, as the file says it.
  std::vector<trace::NodeHeader> nodes;  ///< All, with their names in the log.
  std::vector<trace::LinkHeader> links;  ///< Those whose names do not say of what kind they are.
  std::vector<machine::Role> roles;      ///< Roles of its nodes under test, each once.
  std::vector<ReqId> requirements;       ///< Named by its lines, each once.
  std::uint32_t repeat = 0;              ///< Counted from 0 where --repeat asks for more than one.
  std::uint64_t seed = 0;                ///< Its nodes began with this.
  std::string profile;                   ///< "paper" or "deployed": the profile set for it.
  runner::CaseResult result;             ///< With failures and log.
  /// Lines that the reference machine breaks too when it plays this profile, since golden traces
  /// follow the paper.
  std::vector<std::uint32_t> lines_of_profile;
  Expectation expectation = Expectation::kNone;
  std::string expected_reason;  ///< From the file.
  /// Skipped, as it needs a role that the implementation does not play, or is for other values than
  /// it states.
  bool foreign = false;
  std::string ruled_out;  ///< What is stated and keeps the case from being run: "members=8".
  /// It had to be decided and was not: the case is not foreign, and the file does not list it as
  /// skipped. At a node's own line, which names what it cannot show, only where that line lost or
  /// doubled something, or its application answered `unsupported`.
  bool owed = false;
  runner::Ticks channel_access = 0;  ///< It fails, and passes if its nodes state this much.
  bool whole = false;  ///< Its log has all that its nodes got and did, in virtual time.
  double wall_ms = 0;
  std::string stderr_text;  ///< Written while it broke.

  /// Returns whether it is skipped or inconclusive.
  bool undecided() const;
  /// Returns whether it keeps the run from being as expected: an error, a failure that the file
  /// does not have in this form, the pass of an expected failure, or a verdict that is owed.
  bool unexpected() const;
};

/// A fault outside of the cases.
struct OutsideFault {
  std::string when;         ///< "before j1.request", "after its last case", "after `bye`".
  std::string text;         ///< "was killed by signal 9 (Killed)".
  bool broke = false;       ///< It died or spoke there; else it only did not end as `bye` asks for.
  std::string stderr_text;  ///< Written then.
  ReqId open = ReqId::kNone;  ///< The rule that it leaves open, unless cases decide that.
};

/// All cases on one implementation.
struct ImplementationRun {
  std::string target;  ///< As the user wrote it.
  targets::Identity identity;
  std::string dishonest;              ///< Why nothing else was run; mostly empty.
  std::string stderr_text;            ///< Its standard error then.
  std::vector<CaseRun> cases;         ///< In the order of files and cases.
  std::vector<OutsideFault> outside;  ///< In the order of the cases that they came before.
  double wall_ms = 0;
};

/// An entry of the file of expected failures that does not hold: it matches no case, or some of its
/// cases pass or fail otherwise.
struct StaleExpectation {
  std::string place;  ///< "file:line".
  std::string text;
};

struct SuiteRun {
  std::string protocol;             ///< The folder of another protocol than RUBICON, or empty.
  std::string profile = "paper";    ///< As the user chose; empty: the protocol has none.
  std::uint64_t seed = 0;           ///< For cases that state none; each repeat adds one.
  std::string shard;                ///< "2/8", or empty.
  std::string app;                  ///< The command that shows applications, or empty.
  trace::Statement stated = {};     ///< By the user, of every implementation.
  std::vector<std::string> traces;  ///< Files and folders of the user; none: the kit's own cases.
  std::vector<ImplementationRun> implementations;
  std::vector<StaleExpectation> stale;
  std::size_t rules_required = 0;  ///< That each implementation has to decide.
};

/// How many of an implementation's cases its statements leave to be run.
struct RuledOut {
  std::size_t left = 0;
  std::size_t all = 0;
  std::string by;  ///< "members=8 rules out 3, gone_after=3000 rules out 246"; empty: nothing does.
};
/// Counts the cases of a role, or all that it could play.
RuledOut ruled_out(const ImplementationRun& implementation,
                   std::optional<machine::Role> role = std::nullopt);

/// Returns 0 as expected, 1 for an unexpected failure or an expectation that does not hold, 2 for
/// an error, a dishonest implementation, or one that broke between cases, and 3 if it is
/// incomplete.
int exit_code(const SuiteRun& run);
/// Returns why an implementation's run is incomplete: cases that are owed, nothing that was
/// decided, a rule that was left open, or fewer rules than required. Empty if it is complete.
std::string incomplete(const SuiteRun& run, const ImplementationRun& implementation);

using VerdictCounts = std::map<runner::CaseVerdict, std::size_t>;
VerdictCounts count(const ImplementationRun& run);

/// Results of the cases of one rule, for the summary of requirements.
struct RequirementSummary {
  ReqId requirement = ReqId::kNone;
  VerdictCounts cases;
  std::size_t broken = 0;     ///< Cases with a failure that blames this rule.
  std::size_t suspected = 0;  ///< Others in which a failed line names it, or an implied failure.
};
/// Returns every rule that a case of the run names or shows broken, in the catalogue's order.
std::vector<RequirementSummary> by_requirement(const ImplementationRun& run);

/// Results of the rules of behaviour, and of those of the wire that were broken: each counts once.
struct RuleTotals {
  std::size_t all = 0;   ///< In the catalogue, but for those of the wire that were not broken.
  std::size_t kept = 0;  ///< A case that names it passed, none broke it, and none makes it suspect.
  std::size_t broken = 0;
  std::size_t suspected = 0;  ///< No case broke it for sure, but what one broke may come from it.
  std::size_t undecided = 0;  ///< Cases name it, but they ended before it was decided.
  std::size_t untried = 0;    ///< No case names it that was run.
};
RuleTotals rule_totals(const ImplementationRun& run);

}  // namespace rubric::suite
