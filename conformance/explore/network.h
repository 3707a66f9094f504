// A network's state, as a few numbers, and all its successors.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "conformance/explore/nodes.h"

namespace rubric::explore {

/// A copy of a frame in the air. Every node that it is addressed to may hear it, at once or, while
/// the copy stays, one by one.
struct Copy {
  std::uint32_t bits = 0;

  static Copy of(FrameId frame, std::size_t sender) {
    return {static_cast<std::uint32_t>(std::size_t{frame} << 8 | sender)};
  }
  FrameId frame() const { return static_cast<FrameId>(bits >> 8); }
  std::size_t sender() const { return bits & 0xFF; }
  friend bool operator==(Copy, Copy) = default;
};
/// A set of nodes, one bit each.
using NodeSet = std::uint8_t;

/// Nodes and the frames in flight between them. Copies are ordered by sender, then by sending, as
/// far as that can be told, else by frame: see Network::fly.
struct World {
  static constexpr std::size_t kCopiesMax = 32;
  static constexpr std::size_t kOwnCopiesMax = 14;  ///< Of one sender.
  std::array<NodeId, kNodesMax> node{};
  std::uint32_t copies = 0;
  std::uint32_t doubled = 0;  ///< How often a copy stayed, if that is limited.
  std::array<Copy, kCopiesMax> copy;

  World() = default;
  World(const World& other) { *this = other; }
  World& operator=(const World& other) {
    node = other.node;
    copies = other.copies;
    doubled = other.doubled;
    std::memcpy(copy.data(), other.copy.data(), copies * sizeof(Copy));
    return *this;
  }
  void erase(std::size_t i) {
    --copies;
    std::memmove(&copy[i], &copy[i + 1], (copies - i) * sizeof(Copy));
  }
};

/// A move from one state of the network to the next.
struct Move {
  enum class Kind : std::uint8_t {
    kStep,     ///< `what` happens at `node`.
    kDeliver,  ///< `hearers` hear the copy. It is gone, unless `stays`.
    kLose,     ///< The copy is lost.
    kCollide,  ///< The copy and `other` are, but for those that hear only one of them.
  };
  Kind kind = Kind::kStep;
  std::uint8_t node = 0;
  bool stays = false;      ///< In the air: it may be heard again.
  bool confirmed = false;  ///< The sender got a link ack.
  NodeSet hearers = 0;
  NodeSet other_hearers = 0;
  std::uint32_t what = 0;
  Copy copy;
  Copy other;
};

/// A successor state, and the move to it.
struct Successor {
  World world;
  Move move;
  Mask violated = 0;
  Mask goals = 0;
};

/// Successors of one state, in an order that depends on the state alone. Keeps its memory.
class Successors {
 public:
  void clear() { count_ = 0; }
  /// Adds one, whose state is `world` until it is changed.
  Successor& push(const World& world) {
    if (count_ == items_.size()) items_.emplace_back();
    Successor& next = items_[count_++];
    next.world = world;
    next.move = {};
    next.violated = next.goals = 0;
    return next;
  }
  /// Leaves out those for which `wanted` returns false.
  template <class Wanted>
  void keep(const Wanted& wanted) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      if (wanted(items_[i])) std::swap(items_[kept++], items_[i]);
    }
    count_ = kept;
  }
  std::size_t size() const { return count_; }
  const Successor& operator[](std::size_t i) const { return items_[i]; }
  const Successor* begin() const { return items_.data(); }
  const Successor* end() const { return items_.data() + count_; }

 private:
  std::vector<Successor> items_ = std::vector<Successor>(64);
  std::size_t count_ = 0;
};

/// One thread's view of the network.
class Network {
 public:
  explicit Network(Nodes& nodes);

  World initial() const;
  /// Puts a copy in the air, unless as many of the same are in flight as may be.
  void fly(World& world, Copy copy);
  /// Fills in all successors.
  void successors(const World& world, Successors& out);
  /// Returns the properties that this state itself breaks. `ways_on`: its successors.
  Mask violated(const World& world, const Successors& ways_on);
  /// Returns whether nothing happens any more but what comes from outside: calls, reboots, sends.
  bool rests(const World& world, const Successors& ways_on) const;
  /// Returns what breaks if faults stop in a state that rests. violated() has asked it already.
  Mask broken_by_healing(const World& world);
  Mask goals(const World& world) const;
  /// Returns whether nothing is left to do: no call open, nothing in flight or waiting.
  bool at_rest(const World& world) const;

  /// Returns whether a frame did not find room in flight: the search is then not complete.
  bool overflowed() const { return overflowed_; }
  /// Counts states at rest from which a mote cannot join, since it has rebooted and its sink lists
  /// it.
  std::uint64_t known_weak() const { return known_weak_; }

  /// Puts a copy in its place.
  void put(World& world, Copy copy) const;

 private:
  friend class Healing;
  const NodeFacts& facts(const World& world, std::size_t node) const {
    return nodes_.facts(world.node[node]);
  }
  void add_step(const World& world, std::size_t node, std::uint32_t what, Successors& out);
  void node_moves(const World& world, std::size_t node, Successors& out);
  void copy_moves(const World& world, std::size_t i, Successors& out);
  void collisions(const World& world, Successors& out);
  void collide(const World& world, std::size_t i, std::size_t k, Successors& out);
  void deliver(const World& world, std::size_t i, NodeSet hearers, bool stays, Successors& out);
  void hear(World& world, Copy copy, NodeSet hearers, Successor* successor);
  NodeSet addressed(Copy copy) const;
  void apply(World& world, std::size_t node, std::uint32_t what, Successor* successor);
  bool ordered(Copy a, Copy b) const;
  void take(World& world, std::size_t i) const;
  bool may_stay(const World& world) const;
  bool is_first(const World& world, std::size_t i) const;
  bool in_flight(const World& world, Copy copy) const;

  Nodes& nodes_;
  OutcomeCache outcomes_;
  std::size_t count_;
  std::array<std::uint16_t, kNodesMax> am_address_{};
  std::uint64_t known_weak_ = 0;
  bool overflowed_ = false;
};

}  // namespace rubric::explore
