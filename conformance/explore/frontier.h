// States that wait to be expanded, packed one after the other.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/explore/network.h"

namespace rubric::explore {

/// The state, and the index among its successors, from which a state was reached first.
struct PathLink {
  static constexpr std::uint16_t kStart = 0xFFFF;
  std::uint32_t index = 0;  ///< Index among the states of its thread.
  std::uint16_t thread = 0;
  std::uint16_t way = kStart;
};

/// Neighbouring states of one thread.
struct Chunk {
  const std::uint8_t* bytes = nullptr;
  std::size_t states = 0;
  std::uint32_t first_index = 0;
  std::uint8_t thread = 0;
};

class Frontier {
 public:
  void add(const Network& network, const World& world, std::uint32_t index, std::uint8_t thread) {
    if (states_ % kChunkStates == 0) marks_.push_back({bytes_.size(), index, thread});
    ++states_;
    std::array<std::uint8_t, kPackedMax> packed;
    const std::size_t size = network.pack(world, packed.data());
    bytes_.insert(bytes_.end(), packed.data(), packed.data() + size);
  }
  std::size_t states() const { return states_; }
  /// Appends its chunks, which stay valid while it is neither moved nor added to.
  void chunks(std::vector<Chunk>& out) const {
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const bool last = i + 1 == marks_.size();
      const std::size_t states = last ? states_ - i * kChunkStates : kChunkStates;
      out.push_back(
          {bytes_.data() + marks_[i].offset_bytes, states, marks_[i].index, marks_[i].thread});
    }
  }

 private:
  static constexpr std::size_t kChunkStates = 512;
  static constexpr std::size_t kPackedMax = 3 * kNodesMax + 2 + 3 * World::kCopiesMax;
  struct Mark {
    std::size_t offset_bytes;
    std::uint32_t index;
    std::uint8_t thread;
  };
  std::vector<std::uint8_t> bytes_;
  std::vector<Mark> marks_;
  std::size_t states_ = 0;
};

}  // namespace rubric::explore
