// Runs mutants on golden traces: which trace finds a mutant, and by which rule.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/selftest/mutants/mutant.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/trace/parse.h"

namespace rubric::mutants {

/// A golden trace in its file.
struct CaseRef {
  const trace::Parsed* file;
  const trace::Case* one;
};

/// The golden traces.
class Golden {
 public:
  /// Reads all .rtr files below the folder. Throws std::runtime_error.
  explicit Golden(const std::string& folder);
  explicit Golden(std::vector<trace::Parsed> files);

  /// Returns the traces that the machine passes: no other can tell a mutant from it.
  const std::vector<CaseRef>& cases() const { return cases_; }
  /// Returns the traces that it does not pass.
  const std::vector<CaseRef>& broken() const { return broken_; }
  const std::vector<trace::Parsed>& files() const { return files_; }

  /// Returns whether the mutant may differ from the machine in the case of this name: the machine
  /// does there what the mutant acts on.
  bool acts(const Mutant& mutant, const std::string& case_name) const;
  /// Returns what the machine does in the case of this name, as kinds_of() says it.
  const std::set<std::string>& kinds(const std::string& case_name) const {
    return kinds_.at(case_name);
  }

 private:
  std::vector<trace::Parsed> files_;
  std::map<std::string, std::set<std::string>> kinds_;  // Of each case.
  std::vector<CaseRef> cases_;
  std::vector<CaseRef> broken_;
};

/// Rules of failing lines, and how many of them are the mutant's.
struct Blame {
  std::size_t rules = 0;
  std::size_t right = 0;
};

struct Found {
  bool killed = false;
  bool named = false;  ///< A failing line names one of the mutant's rules, or it names none.
  std::string by;      ///< The trace that killed it; the one that named its rule, if any.
  std::string lines;   ///< The failures there.
  Blame named_there;   ///< The rules that these lines name, each once.
  Blame blamed_there;  ///< Those that the failures blame.
};

/// Runs the case on it. Everything but a pass kills: the machine itself passes.
runner::CaseResult run(const CaseRef& ref, const runner::SubjectFactory& make);
/// Runs it on an implementation that states this.
runner::CaseResult run(const CaseRef& ref, const runner::SubjectFactory& make,
                       const trace::Statement& stated);
/// Tries the cases, those first that name one of the rules, until one kills it by such a rule.
Found hunt(const Golden& golden, const Mutant& mutant);
/// Hunts all of them on so many threads.
std::vector<Found> hunt_all(const Golden& golden, const Mutants& mutants, unsigned threads);

/// A mutant that no golden trace finds, and why. In names `*` matches anything.
struct Survivor {
  const char* name;
  const char* reason;
  bool equivalent = true;  ///< The change is free or unseen. False: it is merely not judged.
};
std::span<const Survivor> survivors();
/// Returns the entry for a mutant of this name, or null.
const Survivor* find_survivor(std::string_view name);

// Mutants made from the machine's observed actions in the golden traces, so that a new message,
// notice or rule is covered without further work.

/// Calls `see` after each step of the machine in each golden trace, with the state before it.
using Witness = std::function<void(const State& before, Ticks now, const Event&, const State& after,
                                   const Actions&)>;
void watch(const Golden& golden, const Witness& see);

/// Returns the kind of an action: "send J3-REPLY join_reply", "tell J5-SUCCESS joined"; empty for
/// labels.
std::string kind_of(const Action& action, const Actions& actions);

/// Returns the kind of each action, and "ignore N3-DUPLICATE" where it is a label.
std::set<std::string> kinds_of(const Actions& actions);

/// A field of a frame that can be changed.
struct FieldPlace {
  std::string path;              ///< "am.dest", "dest.pid", "payload.body.seq_num".
  std::size_t offset_bytes = 0;  ///< In the payload; not of the AM addresses.
  std::size_t size_bytes = 0;
  bool little_endian = false;
};
/// The messages from the outermost in, "net_msg rubicon_ack", and every field.
struct Anatomy {
  std::string name;
  std::vector<FieldPlace> places;
};
Anatomy anatomy(const Transmit& frame);

/// Returns mutants that drop, double, or delay by a period each kind of action.
Mutants action_mutants(const Golden& golden);
/// Returns mutants that change each field of each frame and notice: plus one, and its highest bit.
Mutants field_mutants(const Golden& golden);
/// Returns mutants that accept where an `ignored` names a rule, in each way that leaves nothing to
/// ignore.
Mutants acceptance_mutants(const Golden& golden);
/// Returns the rules of an `ignored` that no way turned into acceptance.
std::vector<std::string> never_accepted(const Golden& golden);

Mutants generated_mutants(const Golden& golden);

/// A way to accept what a rule ignores: mends the frame, or the state for this one step.
struct Mend {
  std::string name;
  /// Returns false if it is not applicable; it did nothing then.
  std::function<bool(Moment&)> step;
};
std::span<const Mend> mends();

}  // namespace rubric::mutants
