// Makes a trace as small as possible while it still shows its purpose.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "conformance/test/runner/run_case.h"
#include "conformance/trace/trace.h"

namespace rubric::shrink {

/// Returns whether a file with this one case still shows the thing. Files passed to it pass
/// trace::check().
using StillShows = std::function<bool(const trace::File&)>;

struct Shrunk {
  trace::File file;  ///< Headers and one case.
  std::size_t lines_before = 0;
  std::size_t lines = 0;
  std::size_t tried = 0;  ///< Calls of `still_shows`.
};

/// Shrinks by delta debugging (Zeller and Hildebrandt's ddmin) over the lines of the case, then
/// over the parts of each line: fields, times, requirements, labels, and the nodes of the file. The
/// result is 1-minimal: without any one of its lines it does not show the thing, or makes no sense.
/// `one` itself has to show it, else lines_before is 0 and the file holds it unchanged.
Shrunk shrink(const trace::File& file, const trace::Case& one, const StillShows& still_shows);

/// An implementation, the profile that it is to play (empty: the trace's), and what it states.
struct Player {
  runner::TargetFactory make;
  std::string profile;
  trace::Statement stated = {};
};

/// Returns one case of a file, with the headers that apply to it.
trace::File only(const trace::File& file, const trace::Case& one);
/// Runs the only case of `file`.
runner::CaseResult play(const trace::File& file, const Player& player);

/// Returns a predicate: `player` fails at the same line and by the same rule as in the first
/// failure of `first`, and not as a consequence of another one. All `references`, which pass the
/// original, pass the shrunk trace too, with any first sequence number; else the trace would
/// require what no rule requires.
StillShows fails_alike(const runner::CaseResult& first, const Player& player,
                       const std::vector<Player>& references);

/// Returns whether one keeps what the other breaks, or dies where the other does not. Freedom
/// within the rules is no difference.
bool differ(const runner::CaseResult& a, const runner::CaseResult& b);

struct Difference {
  Shrunk shrunk;
  std::string case_name;  ///< In the trace from which it was made.
  runner::CaseResult a;   ///< On the shrunk trace.
  runner::CaseResult b;
};

struct DifferenceSearch {
  std::optional<Difference> shortest;
  std::size_t compared = 0;            ///< Cases that both played.
  std::size_t skipped = 0;             ///< Cases that one of them cannot play or did not begin.
  std::vector<std::string> different;  ///< Names of all cases that differ,
  std::vector<std::string> both_died;  ///< and of those in which both died: none is compared.
};

/// Runs all cases on both, shrinks those that differ, beginning with the smallest and at most
/// `shrunk_max` of them, and keeps the shortest. One that dies in a case, hangs or writes nonsense
/// breaks it.
DifferenceSearch find_difference(const std::vector<const trace::File*>& files, const Player& a,
                                 const Player& b, std::size_t shrunk_max = 8);

}  // namespace rubric::shrink
