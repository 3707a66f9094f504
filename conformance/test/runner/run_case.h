// Runs a golden trace on implementations: gives them its inputs and compares their outputs with
// what the lines require.
//
// Lines run in their order. `<` happens at its time, or at once if that has passed. `>` takes the
// first output of that node and link, after the one taken last, that matches in time. `?>` takes
// one output more, if there is one, when the case is over; `!>` forbids outputs that no line took,
// and is judged after that. Outputs that no line names are allowed.
//
// After a `>` line that found nothing the case goes on: stimuli are given as if the output had come
// at the end of its window, and lines that count from it or use its variables are not judged. The
// case ends at a stimulus that needs such a variable, or if the line is weak.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/runner/case_log.h"
#include "conformance/test/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Up to kError in the order of gravity. kInconclusive: no MUST was broken, but the target does not
/// show everything; kError: the case itself makes no sense here, or the target did not start;
/// kSkip: the target reports that it cannot do what the case needs.
enum class CaseVerdict : std::uint8_t { kPass, kWeak, kInconclusive, kFail, kError, kSkip };
std::string_view verdict_text(CaseVerdict verdict);

/// A line that was not kept, or the death of the target.
struct Failure {
  trace::Place place;                     ///< Place of the line in its file.
  std::vector<std::string> requirements;  ///< The rule that is blamed; none if the line names none.
  bool weak = false;                      ///< All rules of the line are SHOULD.
  Ticks time = 0;                         ///< When the breaking output came, or its time was over.
  std::string expected;                   ///< The line.
  std::string text;                       ///< The actual event, with the nearest miss.
  Ticks from = 0;                         ///< The line's time, since the start of the case.
  Ticks to = 0;
  bool forbidden = false;  ///< The line says what must not be emitted.
  /// The target died, hung or wrote nonsense after the line, which gave it something last; or at
  /// the start of the case, whose place it is then.
  bool crash = false;
  std::string node = {};                    ///< The node under test, as the trace calls it.
  std::vector<std::string> suspected = {};  ///< Other rules that the line names.
  bool implied = false;    ///< An earlier failure of the node, or another's rule, can be its cause.
  std::string cause = {};  ///< That rule, which other failures of the run blame.
  /// When the node broke the line: when an output came that differs, else at `time`. Failures are
  /// in this order.
  Ticks broken_at = 0;
  std::string message = {};  ///< That of the line.
  /// What is wrong with one that came: the words of runner::Evidence. Empty if none came.
  std::set<std::string, std::less<>> symptom = {};
  /// When what the line asks for came too early or too late.
  std::optional<Ticks> elsewhere = {};
  std::string prompt = {};  ///< The kind of message that it answered: NodeLog::prompt_of().
  /// Rules by which the reference machine did what the node did not, there or before.
  std::set<std::string> left_undone = {};

  /// Returns all rules that the line names, the blamed one first.
  std::vector<std::string> rules() const;
};

struct CaseResult {
  std::string name;
  CaseVerdict verdict = CaseVerdict::kPass;
  std::vector<Failure> failures;
  std::string reason;            ///< Why it is inconclusive, skipped or an error.
  std::set<std::string> unseen;  ///< Links that it looks at and the target does not show.
  bool not_built = false;        ///< Skipped: the target cannot be what the case is for.
  bool refused = false;          ///< Skipped: the program of the target answered `unsupported`.
  bool damaged = false;          ///< Inconclusive: what its line lost or doubled may decide it.
  Ticks length = 0;              ///< Virtual time that passed.
  CaseLog log;                   ///< Everything that was given and came back.
};

/// Makes the implementation for a node under test.
using TargetFactory = std::function<std::unique_ptr<Target>(const trace::NodeHeader& node)>;

/// Runs a case; every node under test gets a target. Does not throw: a case that cannot be run is
/// kError. Nodes that state no `channel_access` are judged as if they had stated this one.
CaseResult run_case(const trace::File& file, const trace::Case& one, const TargetFactory& make,
                    Ticks channel_access = 0);

/// Returns the profile that a trace is for.
machine::Profile profile_of(const trace::Scope& scope);
/// Returns the start configuration of a node of a trace, with what it states.
machine::Config config_of(const trace::Scope& scope, const trace::NodeHeader& node);

/// Returns one paragraph for each failure.
std::string explain(const CaseResult& result, const std::string& file_name);

}  // namespace rubric::runner
