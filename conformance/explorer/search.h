// Breadth-first over all states of a network.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "conformance/explorer/network.h"

namespace rubric::explorer {

/// How far a search is.
struct Progress {
  std::uint64_t states = 0;
  std::uint64_t transitions = 0;
  std::uint32_t depth = 0;
  std::uint64_t waiting = 0;  ///< States found whose ways on are not known yet.
  double seconds = 0;
};

/// A way from the start to a state, and what it breaks or shows.
struct Path {
  std::vector<Move> moves;
  Mask violated = 0;
};

struct Result {
  Progress progress;
  bool step_acted = false;       ///< The given step once differed from the machine's.
  bool complete = false;         ///< Every state was reached.
  const char* limit = "";        ///< Why not, where it is not for a violation.
  std::optional<Path> violation; ///< A shortest one.
  std::optional<Path> known_weakness;  ///< A shortest way to one, where there are any.
  std::uint64_t known_weak_states = 0;
  Mask goals = 0;                ///< Reached.
  std::size_t node_states = 0;   ///< Different states of single nodes,
  std::size_t frames = 0;        ///< and frames.
  std::size_t memory_bytes = 0;  ///< Of all that was kept, at the end.
  std::size_t memory_per_state_bytes = 0;
};

/// The goals that these options must reach.
Mask expected_goals(const Options& options);

/// Explores. `report`, if any, is called now and then. Counts do not depend on threads; which of
/// several shortest violations is found may.
Result explore(Nodes& nodes, const std::function<void(const Progress&)>& report = {});

}  // namespace rubric::explorer
