// Entry points for the targets whose input is a script.
#include <algorithm>
#include <cstring>
#include <vector>

#include "conformance/selftest/scripts/bytes.h"
#include "fuzz/mutators/script_mutator.h"
#include "fuzz/support/mutate_bytes.h"

namespace {

using namespace rubric;

fuzz::ScriptMutator& seeded_mutator(unsigned seed) {
  static fuzz::ScriptMutator mutator(0);
  mutator.reseed(seed);
  return mutator;
}

// Writes whole steps, as many as there is room for.
std::size_t copy_out(script::Script script, std::uint8_t* data, std::size_t max_size) {
  const std::vector<std::size_t> offsets = script::step_offsets(script);
  std::size_t steps = script.steps.size();
  while (steps > 0 && offsets[steps] > max_size) --steps;
  script.steps.resize(steps);
  const std::vector<std::uint8_t> bytes = script::encode(script);
  const std::size_t size = std::min(bytes.size(), max_size);
  std::memcpy(data, bytes.data(), size);
  return size;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  constexpr unsigned kPlain = 8;  // One in so many is bytes changed anywhere.
  if (seed % kPlain == 0) return fuzz::mutate_bytes(data, size, max_size, seed);
  script::Script script = script::decode(Bytes(data, size));
  seeded_mutator(seed).mutate(script);
  return copy_out(std::move(script), data, max_size);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t max_size,
                                                 unsigned seed) {
  return copy_out(seeded_mutator(seed).cross_over(script::decode(Bytes(one, one_size)),
                                                  script::decode(Bytes(other, other_size))),
                  out, max_size);
}
