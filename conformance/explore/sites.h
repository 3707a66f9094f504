// A network's state as one number a node: its site, that is the node's state with the frames that
// it has in the air.
//
// Sites are few (a mote of 3 motes x 2 sinks has some hundreds), so a state is that many times some
// bits. Where they fit into 64 the state is known by them, one to one, and the visited set leaves
// no state out: the bits are only stirred, by a function that can be undone. Where a site's number
// is too high for its bits, the state is known by 64 bits of hash. With n states of which h are
// hashed, the probability that one of these shares its number with another, and is left out, is at
// most h n / 2^64.
//
// Exchanging motes or sinks (symmetry.h) exchanges sites, by tables. Of an orbit the state whose
// numbers sort first is kept.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "conformance/explore/network.h"
#include "conformance/explore/symmetry.h"

namespace rubric::explore {

using SiteId = std::uint32_t;

/// A node's state and its copies in the air, in their order.
struct Site {
  NodeId node = 0;
  std::uint16_t copies = 0;
  std::array<FrameId, World::kOwnCopiesMax> copy{};
  friend bool operator==(const Site&, const Site&) = default;
};

/// A network's state: its sites, and how often a copy stayed where that is limited.
struct Packed {
  std::array<SiteId, kNodesMax> site{};
  std::uint8_t doubled = 0;
  friend bool operator==(const Packed&, const Packed&) = default;
};

/// What the visited set knows a state by, and whether no other state can have it.
struct StateKey {
  std::uint64_t bits = 0;  ///< Not 0.
  bool exact = true;
};

/// The sites that each node was ever in, each once. Thread-safe.
class Sites {
 public:
  explicit Sites(Nodes& nodes) : symmetry(nodes) {}
  SiteId intern(std::size_t node, const Site& site);
  const Site& get(std::size_t node, SiteId id) const { return of_[node].list[id]; }
  bool full() const { return full_; }
  std::size_t count() const;
  std::size_t memory_bytes() const { return count() * (sizeof(Site) + 48); }

  Symmetry symmetry;

 private:
  struct OfNode {
    ChunkedList<Site> list;
    std::unordered_multimap<std::uint64_t, SiteId> ids;
  };
  std::mutex mutex_;
  std::array<OfNode, kNodesMax> of_;
  bool full_ = false;
};

/// One thread's way to and from packed states, with its own caches.
class Packer {
 public:
  Packer(Nodes& nodes, Sites& sites, const Network& network);

  /// Packs a state. If `other` is given, most nodes are as in that one, packed as `packed_other`.
  Packed pack(const World& world, const World* other = nullptr, const Packed& packed_other = {});
  void unpack(const Packed& packed, World& world) const;
  /// Makes of the state the first of its orbit. Returns how many permutations leave that as it is.
  std::size_t sort(Packed& packed);
  /// Returns the state with motes and sinks exchanged.
  Packed exchanged(const Packed& packed, std::size_t g);
  StateKey key(const Packed& packed) const;

 private:
  struct Slot {
    std::uint64_t hash = 0;  ///< 0: free.
    SiteId id = 0;
  };
  SiteId find(std::size_t node, const Site& site);
  SiteId renamed(std::size_t g, std::size_t node, SiteId id);

  Sites& sites_;
  const Network& network_;
  std::size_t count_;
  unsigned site_bits_;
  std::array<std::vector<Slot>, kNodesMax> slots_;
  std::array<std::size_t, kNodesMax> used_{};
  /// By permutation, node and site: the site that it becomes, plus one; 0: not asked yet.
  std::vector<std::array<std::vector<SiteId>, kNodesMax>> renamed_;
  std::vector<Permutation> from_;  ///< The inverses.
};

}  // namespace rubric::explore
