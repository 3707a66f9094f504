// The partial order of motes' steps.
//
// In the join protocol a mote talks with sinks alone, and a sink answers it alone. Call what mote m
// does, what becomes of frames from it and to it, and what sinks make of these the steps of m. If
// steps of different motes are independent (neither enables nor disables the other, and in either
// order they lead to the same state and break the same), a run is a shuffle of one run of each
// mote, and every shuffle of them is a run. What one mote's steps are and lead to is then the same
// whatever the others do. So the search may take, in a state, the steps of one mote m alone: these
// are a persistent set, since whatever others do before stays independent of them. (Godefroid,
// Partial-Order Methods for the Verification of Concurrent Systems, 1996.) It takes a mote that has
// begun before one that has not, and goes on with it until it has no step left.
//
// Nothing is then left out that a property could tell:
//   - Properties of a step, and that a listed mote acked, concern one mote and its sinks. Each
//     state that a mote can be in with its sinks occurs, while the motes before it have ended and
//     those after it have not begun.
//   - Properties of states at rest: one is at rest if every mote is, and the calls that follow once
//     faults have stopped are steps of one mote each, so one fails where that mote alone fails.
//   - Goals are events that some state must show. What is found is there; a goal that needs two
//     motes half way at once would be missed, and the run would fail. None does.
// Proviso: were no run of a mote to end, others would never begin. The search gives no verdict
// unless it saw a state without any way on; all motes ended there, so each has such a run.
//
// Independence is not assumed. motes_are_independent() gives every node each frame that any node
// was ever found to send, in any order, whether the network could bring it there or not, until
// nothing new comes of it: sinks and motes then have all states that they have in the network, with
// one call more for the time after faults, and more. In each state of a sink, and for any two
// frames from different motes, it compares both orders: state, answers, broken properties. And it
// looks that motes hear sinks alone, sinks answer the sender alone, list nobody but the sender, and
// do nothing of their own. A flaw that mixes two joins up fails this, and is searched in full. So
// are networks whose air or clock joins what the nodes do not: collisions, limited doubles,
// --prompt, messages.
#pragma once

#include "conformance/explore/network.h"

namespace rubric::explore {

/// Returns whether the steps of different motes are independent, so that keep_one_mote() loses
/// nothing. False without Options::partial_order, or where that would be much work.
bool motes_are_independent(const Options& options);

/// Leaves of a state's successors those of one mote.
void keep_one_mote(const Nodes& nodes, const World& world, Successors& ways_on);

}  // namespace rubric::explore
