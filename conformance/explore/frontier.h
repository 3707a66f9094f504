// States that wait to be expanded, packed one after the other.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "conformance/explore/sites.h"

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
  void add(const Packed& packed, std::size_t nodes, std::uint32_t index, std::uint8_t thread) {
    if (states_ % kChunkStates == 0) marks_.push_back({bytes_.size(), index, thread});
    ++states_;
    std::array<std::uint8_t, kSiteBytes * kNodesMax + 1> record;
    std::uint8_t* at = record.data();
    for (std::size_t i = 0; i < nodes; ++i, at += kSiteBytes) {
      std::memcpy(at, &packed.site[i], kSiteBytes);
    }
    *at++ = packed.doubled;
    bytes_.insert(bytes_.end(), record.data(), at);
  }
  /// Reads a record that add() has made. Returns its size.
  static std::size_t read(const std::uint8_t* bytes, std::size_t nodes, Packed& packed) {
    for (std::size_t i = 0; i < nodes; ++i, bytes += kSiteBytes) {
      packed.site[i] = 0;
      std::memcpy(&packed.site[i], bytes, kSiteBytes);
    }
    packed.doubled = *bytes;
    return kSiteBytes * nodes + 1;
  }
  std::size_t states() const { return states_; }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
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
  static constexpr std::size_t kSiteBytes = 3;
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
