// The symmetry of motes and of sinks.
//
// Motes differ in nothing but their ids and first numbers, sinks in nothing but their islands. To
// exchange two of them in every id, number, list and frame of a network's state is a permutation g
// of states. If each way on from a state s leads from g(s) to the exchanged result, all runs come
// in such sets, and it is enough to follow one of each: the search keeps, of the states that are s
// with motes and sinks exchanged (its orbit), the one that sorts first (Packer::sort). Properties
// are kept or broken by all of an orbit, or, where they depend on an order (Healing), asked of
// each. (Ip and Dill, Better verification through symmetry, 1996.)
//
// Nothing here knows which fields of a node hold an id. A state of a node and a frame are renamed
// by how they came about: g of what an event makes of s is what g of the event makes of g(s), from
// g of the first state on. That this is well defined, and that the machine (or the flaw around it)
// has the symmetry at all, is not assumed: holds() compares every step that was ever computed with
// its exchanged ones: the next state, frames, facts, broken properties. Since a step of the network
// is made of steps of nodes, and of the addresses of frames, which it compares too, the network's
// states have the symmetry if it returns true.
//
// A state that some permutations leave as it is has a smaller orbit: as many states as there are
// permutations, divided by those. The search adds these sizes up; the sum is the number of states
// that there are without the reduction, and a test compares.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "conformance/explore/nodes.h"

namespace rubric::explore {

/// What each node becomes.
using Permutation = std::array<std::uint8_t, kNodesMax>;

/// Exchanges motes for motes and sinks for sinks. Thread-safe.
class Symmetry {
 public:
  explicit Symmetry(Nodes& nodes);

  /// Returns all permutations; the first changes nothing. Only that one without Options::symmetry.
  const std::vector<Permutation>& group() const { return group_; }
  /// Return what a node's state, an event of it, and a frame become. `g` is an index into group().
  NodeId node(NodeId id, std::size_t g);
  std::uint32_t event(NodeId node, std::uint32_t what, std::size_t g);
  FrameId frame(FrameId id, std::size_t g);

  /// Compares all steps that were computed with their exchanged ones.
  bool holds();

 private:
  std::optional<std::uint32_t> choice(NodeId node, std::uint32_t what, std::size_t g);
  NodeFacts facts(const NodeFacts& of, std::size_t g);
  bool same(const Outcome& outcome, std::size_t g);
  bool same_frame(FrameId id, std::size_t g);

  Nodes& nodes_;
  std::vector<Permutation> group_;
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, std::uint32_t> renamed_;  ///< Of nodes' states.
};

}  // namespace rubric::explore
