// Whether what was begun ends: a joinIsland call in its joined event, a reliable message in its
// receive_ack. The search (search.h) finds networks that stand still before that; here are the runs
// that go on for ever.
//
// A run counts only if it is fair:
//   - What a node can do by itself all the time, it does: a timer that stays set fires, a
//     transmission ends. (Weak fairness. Calls, sends and reboots come from outside and need not.)
//   - So is doubling: a frame does not stay in the air for ever, where it would hold others back.
//   - Loss is fair: a frame that is in the air again and again is heard again and again, by each
//     node that it is addressed to. (Strong fairness.) Losing every frame for ever is no run of a
//     network that one would want to judge.
// In a finite graph a run that never ends stays, from some moment on, in one strongly connected
// part of it, and sees all of some such part again and again. So there is a fair run in which
// something waits for ever exactly if there is a strongly connected part of the states where it
// waits (with at least one step) in which, for each event of a node, some state does not have it or
// some step takes it, and each hearing that some state has is taken by some step. Parts are found
// by Tarjan's algorithm. A part in which a hearing can happen but is never taken is looked at again
// without the states that have it, since a fair run must stay away from them (Emerson and Lei,
// Modalities for model checking, 1987). What waits is the same in all states of a part: calls and
// sends are counted, so nothing new begins inside.
//
// The answer is a lasso: a shortest way to the part, and a loop through it that takes every hearing
// and every event that the conditions ask for.
//
// Neither symmetry nor partial order is used: in an orbit one mote's step passes for another's, and
// fairness asks who. All states and steps are kept in memory, so five million states are the most.
#pragma once

#include <optional>

#include "conformance/explore/search.h"

namespace rubric::explore {

struct Liveness {
  std::optional<Path> violation;  ///< With Path::loop.
  std::uint64_t states = 0;
  std::uint64_t parts = 0;  ///< Strongly connected ones in which something waits.
  const char* limit = "";   ///< Why not everything was looked at.
};

/// Looks for a fair run that breaks kOneTerminal or kReliableEnds, of those that
/// Options::properties asks for. A reliable message need not end where the profile has no ack
/// timeout.
Liveness look_for_loops(Nodes& nodes);

}  // namespace rubric::explore
