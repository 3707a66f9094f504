// Works a golden trace on implementations: gives what its lines give, and holds what comes back
// against what they ask for.
//
// Lines are worked in their order. `<` happens at its time, or at once if that has passed. `>`
// takes the first output of that node and link, behind the one taken last, that matches in time.
// `?>` takes one output more, if there is one, when the case is over; `!>` forbids outputs that no
// line took, and is judged after that. What no line names is free.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/runner/target.h"
#include "conformance/trace/trace.h"

namespace rubric::runner {

/// Up to kError in the order of gravity. kInconclusive: nothing was broken, but the target does not
/// let all of it be seen; kError: the case itself makes no sense here, or the target broke;
/// kSkip: the target says that it cannot do what the case needs.
enum class CaseVerdict : std::uint8_t { kPass, kWeak, kInconclusive, kFail, kError, kSkip };
std::string_view verdict_text(CaseVerdict verdict);

/// A line that was not kept.
struct Failure {
  trace::Place place;                     ///< Of the line in its file.
  std::vector<std::string> requirements;  ///< That the line names.
  bool weak = false;                      ///< All of these are SHOULD.
  Ticks time = 0;                         ///< Of the output that breaks it, or the end of its time.
  std::string expected;                   ///< The line.
  std::string text;                       ///< What happened instead, with the nearest miss.
  Ticks from = 0;                         ///< The line's time, since the start of the case.
  Ticks to = 0;
  bool forbidden = false;                 ///< The line says what must not be emitted.
};

struct CaseResult {
  std::string name;
  CaseVerdict verdict = CaseVerdict::kPass;
  std::vector<Failure> failures;
  std::string reason;       ///< Why it is inconclusive, skipped or an error.
  Ticks length = 0;         ///< Virtual time that passed.
  trace::Case log;  ///< Everything that was given and came back.
};

/// Makes the implementation for a node under test.
using TargetFactory = std::function<std::unique_ptr<Target>(const trace::NodeHeader& node)>;

/// Every node under test of the case gets a target. Does not throw: a case that cannot be worked
/// is kError.
CaseResult run_case(const trace::File& file, const trace::Case& one, const TargetFactory& make);

/// How a node of a trace starts.
machine::Config config_of(const trace::Scope& scope, const trace::NodeHeader& node);

/// One paragraph for each failure.
std::string explain(const CaseResult& result, const std::string& file_name);

}  // namespace rubric::runner
