// The common part of the entry points for engines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "codec/generated/rubicon/messages.h"
#include "codec/reflect/registry.h"
#include "fuzz/mutators/packet_mutator.h"

namespace rubric::fuzz {

/// Returns the mutator of RUBICON's streams, made once; the seed alone decides what it does next.
inline PacketMutator& seeded_mutator(unsigned seed) {
  static PacketMutator mutator(*reflect::find_protocol("rubicon"), rubicon::messages::kRoutes, 0);
  mutator.reseed(seed);
  return mutator;
}

/// libFuzzer asks for a cross-over as often as for a mutant. One of so many is enough; it asks
/// again for the others.
inline constexpr unsigned kCrossOversAsked = 4;

/// Copies `out` to the engine, after the head that `data` already has.
inline std::size_t copy_out(const std::vector<std::uint8_t>& out, std::size_t head_bytes,
                            std::uint8_t* data, std::size_t max_size) {
  const std::size_t size = std::min(out.size(), max_size - head_bytes);
  if (size != 0) std::memcpy(data + head_bytes, out.data(), size);
  return head_bytes + size;
}

}  // namespace rubric::fuzz
