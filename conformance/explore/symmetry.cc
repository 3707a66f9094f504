#include "conformance/explore/symmetry.h"

#include <algorithm>
#include <numeric>

namespace rubric::explore {
namespace {

// Returns the bits of `set`, each at its new place; `first` is the node that bit 0 stands for.
std::uint8_t moved(std::uint8_t set, const Permutation& to, std::size_t first) {
  unsigned out = 0;
  for (std::size_t i = 0; first + i < kNodesMax; ++i) {
    if ((set >> i & 1) != 0) out |= 1U << (to[first + i] - first);
  }
  return static_cast<std::uint8_t>(out);
}

bool is_transposition(const Permutation& to) {
  int moves = 0;
  for (std::size_t i = 0; i < kNodesMax; ++i) moves += to[i] != i;
  return moves == 2;
}

}  // namespace

Symmetry::Symmetry(Nodes& nodes) : nodes_(nodes) {
  Permutation to;
  std::iota(to.begin(), to.end(), std::uint8_t{0});
  const auto sinks = to.begin() + nodes.options().motes;
  const auto end = to.begin() + static_cast<std::ptrdiff_t>(nodes.count());
  do {
    do group_.push_back(to);
    while (nodes.options().symmetry && std::next_permutation(sinks, end));
  } while (nodes.options().symmetry && std::next_permutation(to.begin(), sinks));
}

NodeId Symmetry::node(NodeId id, std::size_t g) {
  if (g == 0) return id;
  const std::uint64_t key = std::uint64_t{id} << 8 | g;
  {
    const std::lock_guard lock(mutex_);
    const auto found = renamed_.find(key);
    if (found != renamed_.end()) return found->second;
  }
  const Origin& origin = nodes_.origin(id);
  const NodeId out =
      origin.what == Origin::kStart
          ? nodes_.initial(group_[g][nodes_.facts(id).node])
          : nodes_.outcome(node(origin.before, g), event(origin.before, origin.what, g)).next;
  const std::lock_guard lock(mutex_);
  renamed_.emplace(key, out);
  return out;
}

FrameId Symmetry::frame(FrameId id, std::size_t g) {
  if (g == 0 || id == 0) return id;
  const Origin& origin = nodes_.frame_origin(id);
  return nodes_.outcome(node(origin.before, g), event(origin.before, origin.what, g))
      .frame[origin.frame];
}

std::uint32_t Symmetry::event(NodeId node, std::uint32_t what, std::size_t g) {
  if (what >= event::kFrame) {
    return event::kFrame + frame(static_cast<FrameId>(what - event::kFrame), g);
  }
  if (what >= event::kSend) return choice(node, what, g).value_or(what);
  return what;
}

// Returns the choice of the exchanged node that is for the exchanged destination.
std::optional<std::uint32_t> Symmetry::choice(NodeId node, std::uint32_t what, std::size_t g) {
  const auto choices_of = [&](NodeId id) {
    const NodeState& state = nodes_.state(id);
    return nodes_.choices(state.state, state.monitor);
  };
  const Permutation& to = group_[g];
  const Options& options = nodes_.options();
  SendChoice wanted = choices_of(node)[what - event::kSend];
  const unsigned mote = unsigned{wanted.dest.devid} - kFirstMoteId;
  const unsigned sink = unsigned{wanted.dest.pid} - kFirstIsland;
  if (mote < options.motes) wanted.dest.devid = static_cast<std::uint16_t>(kFirstMoteId + to[mote]);
  if (sink < options.sinks) {
    wanted.dest.pid =
        static_cast<std::uint16_t>(kFirstIsland + to[options.motes + sink] - options.motes);
  }
  const std::vector<SendChoice> choices = choices_of(this->node(node, g));
  const auto found = std::find(choices.begin(), choices.end(), wanted);
  if (found == choices.end()) return std::nullopt;
  return event::kSend + static_cast<std::uint32_t>(found - choices.begin());
}

NodeFacts Symmetry::facts(const NodeFacts& of, std::size_t g) {
  NodeFacts out = of;
  const Permutation& to = group_[g];
  out.node = to[of.node];
  out.view = moved(of.view, to, nodes_.options().motes);
  out.acked_ever = moved(of.acked_ever, to, nodes_.options().motes);
  out.listed = moved(of.listed, to, 0);
  out.on_air = frame(of.on_air, g);
  return out;
}

// Returns whether both frames go to the same node, exchanged, and ask alike for a link ack.
bool Symmetry::same_frame(FrameId id, std::size_t g) {
  const machine::Transmit& one = nodes_.frame(id);
  const machine::Transmit& other = nodes_.frame(frame(id, g));
  std::uint16_t dest = one.dest;
  for (std::size_t i = 0; i < nodes_.options().motes; ++i) {
    if (nodes_.config_of(i).id == one.dest) dest = nodes_.config_of(group_[g][i]).id;
  }
  return other.dest == dest && other.link_ack == one.link_ack;
}

bool Symmetry::same(const Outcome& outcome, std::size_t g) {
  const NodeId before = node(outcome.of.before, g);
  const std::uint32_t what = event(outcome.of.before, outcome.of.what, g);
  const Outcome& other = nodes_.outcome(before, what);
  // Of the goals one names a sink.
  const Mask sinks = bit(Goal::kJoinedFirst) | bit(Goal::kJoinedSecond);
  const bool alike = other.next == node(outcome.next, g) && other.violated == outcome.violated &&
                     (other.goals & ~sinks) == (outcome.goals & ~sinks) &&
                     other.overflow == outcome.overflow && other.frames == outcome.frames &&
                     nodes_.facts(other.next) == facts(nodes_.facts(outcome.next), g);
  if (!alike || node(other.next, g) != outcome.next) return false;  // Twice is not at all.
  for (std::size_t i = 0; i < outcome.frames; ++i) {
    const FrameId frame = outcome.frame[i];
    if (other.frame[i] != this->frame(frame, g) || !same_frame(frame, g)) return false;
  }
  return true;
}

// The permutations that exchange two nodes make up all others. The comparisons compute further
// steps, which are compared in turn.
bool Symmetry::holds() {
  for (std::size_t i = 0; i < nodes_.outcomes(); ++i) {
    for (std::size_t g = 1; g < group_.size(); ++g) {
      if (is_transposition(group_[g]) && !same(nodes_.outcome_at(i), g)) return false;
    }
  }
  return true;
}

}  // namespace rubric::explore
