#include "conformance/explore/sites.h"

#include <algorithm>

namespace rubric::explore {
namespace {

std::uint64_t fold(std::uint64_t a, std::uint64_t b) {
  const auto product = static_cast<unsigned __int128>(a) * b;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

std::uint64_t hash_of(const Site& site) {
  std::uint64_t hash = std::uint64_t{site.node} << 8 | site.copies;
  for (std::size_t i = 0; i < site.copies; i += 2) {
    const std::uint64_t second = i + 1 < site.copies ? site.copy[i + 1] : 0;
    hash = fold(hash ^ 0x9E3779B97F4A7C15U,
                (std::uint64_t{site.copy[i]} << 16 | second) ^ 0xE7037ED1A0B428DBU);
  }
  hash = fold(hash ^ 0x8EBC6AF09C88C6E3U, 0x589965CC75374CC3U);
  return hash == 0 ? 1 : hash;
}

// Stirs 64 bits. Each result has one origin: a shift onto itself and an odd factor can be undone.
std::uint64_t stir(std::uint64_t bits) {
  bits = (bits ^ bits >> 30) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ bits >> 27) * 0x94D049BB133111EBU;
  return bits ^ bits >> 31;
}

}  // namespace

SiteId Sites::intern(std::size_t node, const Site& site) {
  const std::uint64_t hash = hash_of(site);
  const std::lock_guard lock(mutex_);
  OfNode& of = of_[node];
  const auto [begin, end] = of.ids.equal_range(hash);
  for (auto it = begin; it != end; ++it) {
    if (of.list[it->second] == site) return it->second;
  }
  if (of.list.full()) {
    full_ = true;
    return 0;
  }
  const auto id = static_cast<SiteId>(of.list.size());
  of.list.push(site);
  of.ids.emplace(hash, id);
  return id;
}

std::size_t Sites::count() const {
  std::size_t count = 0;
  for (const OfNode& of : of_) count += of.list.size();
  return count;
}

Packer::Packer(Nodes& nodes, Sites& sites, const Network& network)
    : sites_(sites),
      network_(network),
      count_(nodes.count()),
      site_bits_(std::min(
          24U, (nodes.options().dups == 0 ? 64U : 56U) / static_cast<unsigned>(nodes.count()))),
      renamed_(sites.symmetry.group().size()) {
  for (auto& slots : slots_) slots.resize(1U << 10);
  for (const Permutation& to : sites.symmetry.group()) {
    Permutation from;
    for (std::uint8_t i = 0; i < kNodesMax; ++i) from[to[i]] = i;
    from_.push_back(from);
  }
}

SiteId Packer::find(std::size_t node, const Site& site) {
  std::vector<Slot>& slots = slots_[node];
  const std::uint64_t hash = hash_of(site);
  std::size_t i = hash & (slots.size() - 1);
  for (; slots[i].hash != 0; i = (i + 1) & (slots.size() - 1)) {
    if (slots[i].hash == hash && sites_.get(node, slots[i].id) == site) return slots[i].id;
  }
  const SiteId id = sites_.intern(node, site);
  slots[i] = {hash, id};
  if (2 * ++used_[node] > slots.size()) {
    std::vector<Slot> larger(2 * slots.size());
    for (const Slot& slot : slots) {
      if (slot.hash == 0) continue;
      std::size_t k = slot.hash & (larger.size() - 1);
      while (larger[k].hash != 0) k = (k + 1) & (larger.size() - 1);
      larger[k] = slot;
    }
    slots.swap(larger);
  }
  return id;
}

Packed Packer::pack(const World& world, const World* other, const Packed& packed_other) {
  Packed out{.doubled = static_cast<std::uint8_t>(world.doubled)};
  const auto end_of = [](const World& of, std::size_t node, std::size_t i) {
    while (i < of.copies && of.copy[i].sender() == node) ++i;
    return i;
  };
  std::size_t i = 0;
  std::size_t k = 0;  // In `other`.
  for (std::size_t node = 0; node < count_; ++node) {
    const auto first = world.copy.begin() + static_cast<std::ptrdiff_t>(i);
    const std::size_t end = end_of(world, node, i);
    const std::size_t other_end = other == nullptr ? k : end_of(*other, node, k);
    // A step changes one site or two, and to compare costs less than to look up.
    if (other != nullptr && world.node[node] == other->node[node] && end - i == other_end - k &&
        std::equal(first, first + static_cast<std::ptrdiff_t>(end - i),
                   other->copy.begin() + static_cast<std::ptrdiff_t>(k))) {
      out.site[node] = packed_other.site[node];
      i = end;
    } else {
      Site site{.node = world.node[node]};
      for (; i < end; ++i) site.copy[site.copies++] = world.copy[i].frame();
      out.site[node] = find(node, site);
    }
    k = other_end;
  }
  return out;
}

void Packer::unpack(const Packed& packed, World& world) const {
  world.copies = 0;
  world.doubled = packed.doubled;
  for (std::size_t node = 0; node < count_; ++node) {
    const Site& site = sites_.get(node, packed.site[node]);
    world.node[node] = site.node;
    for (std::size_t i = 0; i < site.copies; ++i) {
      world.copy[world.copies++] = Copy::of(site.copy[i], node);
    }
  }
}

SiteId Packer::renamed(std::size_t g, std::size_t node, SiteId id) {
  std::vector<SiteId>& known = renamed_[g][node];
  if (id < known.size() && known[id] != 0) return known[id] - 1;
  Symmetry& symmetry = sites_.symmetry;
  const std::uint8_t to = symmetry.group()[g][node];
  const Site& site = sites_.get(node, id);
  World air;
  for (std::size_t i = 0; i < site.copies; ++i) {
    network_.put(air, Copy::of(symmetry.frame(site.copy[i], g), to));
  }
  Site out{.node = symmetry.node(site.node, g)};
  for (std::size_t i = 0; i < air.copies; ++i) out.copy[out.copies++] = air.copy[i].frame();
  if (id >= known.size()) known.resize(2 * std::size_t{id} + 64);
  const SiteId found = find(to, out);
  known[id] = found + 1;
  return found;
}

Packed Packer::exchanged(const Packed& packed, std::size_t g) {
  Packed out{.doubled = packed.doubled};
  for (std::size_t node = 0; node < count_; ++node) {
    out.site[sites_.symmetry.group()[g][node]] = renamed(g, node, packed.site[node]);
  }
  return out;
}

std::size_t Packer::sort(Packed& packed) {
  if (from_.size() == 1) return 1;
  const Packed given = packed;
  std::size_t same = 1;
  for (std::size_t g = 1; g < from_.size(); ++g) {
    Packed other{.doubled = given.doubled};
    bool less = false;
    std::size_t i = 0;
    for (; i < count_; ++i) {
      const std::uint8_t from = from_[g][i];
      other.site[i] = renamed(g, from, given.site[from]);
      if (!less && other.site[i] > packed.site[i]) break;
      less |= other.site[i] < packed.site[i];
    }
    if (i < count_) continue;
    if (less) {
      packed = other;
      same = 1;
    } else {
      ++same;
    }
  }
  return same;
}

StateKey Packer::key(const Packed& packed) const {
  const SiteId limit = (SiteId{1} << site_bits_) - 1;
  std::uint64_t bits = packed.doubled;
  bool exact = true;
  for (std::size_t i = 0; i < count_; ++i) {
    bits = bits << site_bits_ | packed.site[i];
    exact &= packed.site[i] < limit;
  }
  if (exact) return {stir(bits + 1), true};  // Not all bits are set, so this is not 0.
  bits = packed.doubled;
  for (std::size_t i = 0; i < count_; ++i) {
    bits = fold(bits ^ packed.site[i] ^ 0x9E3779B97F4A7C15U, 0xE7037ED1A0B428DBU + 2 * i);
  }
  return {bits == 0 ? 1 : bits, false};
}

}  // namespace rubric::explore
