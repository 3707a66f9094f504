// Breadth-first over all states of a network.
//
// Decides: whether any state or step that the model can reach breaks a property (property.h), and
// by which shortest path. It rests on the machine's step() and on the options: how many nodes,
// which faults, how much of each.
//
// The state of a network is a few numbers: one for each node with what it has in the air. Eight
// things keep the number of states small. The first four and the last two change no verdict.
// 1. Nodes (nodes.h). Each state of a node, with the history that its properties need (history.h),
//    is kept once. It is compared as a whole; its hash only finds it. What an event makes of it is
//    computed once, for all network states in which that happens.
// 2. The air (network.h). Copies are kept by sender and not in the order in which different senders
//    sent, or one sent to different nodes, since nobody can observe that. Of two equal copies only
//    the first moves. A hearing by some that ends the copy is left out where one that leaves the
//    copy, followed by its loss, leads to the same state in one step more.
// 3. The past (forget_the_past() in nodes.cc). Fields that the machine never reads again are
//    cleared, and lists that are never full are sorted. Options::exact does without this, and a
//    test holds that verdicts and lengths of counterexamples agree.
// 4. Numbers (sites.h). Where they fit into 64 bits a state is known by them, one to one. Where
//    they do not, by a hash; then a violation could be missed, with a probability that is stated.
//    None is invented: a path is walked again from the start.
// 5. Time. `now` is 0 for ever, and a timer that is set may fire at any moment. Every order that
//    real clocks allow is explored, and more: a counterexample may need an order that clocks
//    forbid. It is walked again with a clock that runs (counterexample.h), so its times show that.
//    With Options::prompt timers fire only when the air is empty, and less is explored.
// 6. Bounds. At most Options::in_flight copies of one frame are in the air. A transmission ends
//    within the step that began it, unless a link ack is awaited or Options::busy is set. Calls,
//    reboots and sends are limited, repeated hearings may be. What lies beyond is not explored, and
//    nothing is said of it.
// 7. Symmetry (symmetry.h). Of all states that differ only in which mote or sink is which, one is
//    kept. Checked against every step of a node; off without Options::symmetry.
// 8. Partial order (independence.h). Where motes' steps are independent, one mote's are taken
//    before the next one's. Checked before the search; off without Options::partial_order.
// Both keep a shortest violation's length: a path's orbit is made of paths, and what one mote
// breaks is broken by the one that is searched first, before any other has begun.
//
// The search goes level by level. Threads share the visited set and find the same states whatever
// their number; only which of several shortest violations is reported may differ.
//
// Cannot know: what only a clock decides (J8-PERIOD, the period of J4-REPEAT), what damaged frames,
// base stations and PEIS do, and larger networks than the one explored.
//
// Reading the answer: a violation is a path of the machine itself, or of the flaw around it.
// `complete` means that every state within the bounds was expanded. A full table, an overflow of
// the air, `states_max` or `memory_max_bytes` clears it, and the verdict is then inconclusive. A
// complete search without a violation still fails if a goal (expected_goals()) was never reached,
// since properties of nothing are true.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "conformance/explore/network.h"

namespace rubric::explore {

/// The progress of a search.
struct Progress {
  std::uint64_t states = 0;
  std::uint64_t transitions = 0;
  std::uint32_t depth = 0;
  std::uint64_t waiting = 0;  ///< States found whose ways on are not known yet.
  double seconds = 0;
};

/// A path from the start to a state, and the properties that it breaks.
struct Path {
  std::vector<Move> moves;
  std::optional<std::size_t> loop;  ///< The moves from here on can go on and on (liveness.h).
  Mask violated = 0;
};

struct Result {
  Progress progress;
  std::uint64_t represented_states = 0;  ///< The sizes of the visited states' orbits, added up.
  bool by_mote = false;                  ///< One mote's steps were taken before the next one's.
  double omission_probability = 0;       ///< A bound for that of having left a state out.
  bool step_acted = false;               ///< The given step once differed from the machine's.
  bool complete = false;                 ///< Every state was reached.
  const char* limit = "";                ///< Why not, unless a violation is the only reason.
  std::optional<Path> violation;         ///< A shortest one.
  std::optional<Path> known_weakness;    ///< A shortest way to one, where there are any.
  std::uint64_t known_weak_states = 0;
  Mask goals = 0;                ///< Reached.
  std::size_t node_states = 0;   ///< Different states of single nodes,
  std::size_t frames = 0;        ///< and frames.
  std::size_t memory_bytes = 0;  ///< For everything kept, at the end.
  std::size_t memory_per_state_bytes = 0;
  std::uint64_t liveness_states = 0;  ///< Looked at for runs that never end; 0: not asked,
  std::uint64_t liveness_parts = 0;   ///< and the parts of the graph where one could stay.
};

/// Returns the goals that these options must reach.
Mask expected_goals(const Options& options);

/// Explores. Calls `report`, if any, now and then. Counts do not depend on threads; which of
/// several shortest violations is found may.
Result explore(Nodes& nodes, const std::function<void(const Progress&)>& report = {});

}  // namespace rubric::explore
