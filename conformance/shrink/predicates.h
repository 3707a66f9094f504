// What a trace can be kept for: a failure of one implementation, or a difference between two.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conformance/runner/run_case.h"
#include "conformance/shrink/shrink.h"

namespace rubric::shrink {

/// An implementation, and the profile that it is asked to play; empty: as the trace says.
struct Player {
  runner::TargetFactory make;
  std::string profile;
};

/// One case of a file, with the headers that hold for it.
trace::File only(const trace::File& file, const trace::Case& one);
/// Works the only case of `file`.
runner::CaseResult play(const trace::File& file, const Player& player);

/// Asks for a failure of `player` that names the same rules as the first failure of `first`, or for
/// the same error. While `reference` passes the original it must pass what is left of it, for else
/// the trace would ask for what no rule asks for; with whatever sequence number it begins.
StillShows fails_alike(const runner::CaseResult& first, const Player& player,
                       const std::optional<Player>& reference);

/// Whether one keeps what the other breaks. Freedom within the rules is no difference.
bool differ(const runner::CaseResult& a, const runner::CaseResult& b);

struct Difference {
  Shrunk shrunk;
  std::string case_name;  ///< Of the trace that it was made of.
  runner::CaseResult a;   ///< Of the shrunk trace.
  runner::CaseResult b;
};

struct DifferenceSearch {
  std::optional<Difference> shortest;
  std::size_t compared = 0;             ///< Cases that both played.
  std::size_t skipped = 0;              ///< Cases that one of them cannot play.
  std::vector<std::string> different;   ///< Names of all cases that differ.
};

/// Works all cases on both, shrinks those that differ, beginning with the smallest and at most
/// `shrunk_max` of them, and keeps the shortest. Throws runner::TargetBroken where one breaks.
DifferenceSearch find_difference(const std::vector<const trace::File*>& files, const Player& a,
                                 const Player& b, std::size_t shrunk_max = 8);

}  // namespace rubric::shrink
