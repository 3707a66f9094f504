// Entry points for targets whose input is a stream or file of one format, RUBRIC_FUZZ_FORMAT.
#include "fuzz/mutators/entry.h"

namespace {

constexpr auto kFormat = rubric::InputFormat::RUBRIC_FUZZ_FORMAT;

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  using namespace rubric::fuzz;
  const auto out = seeded_mutator(seed).mutate(kFormat, rubric::Bytes(data, size), max_size);
  return copy_out(out, 0, data, max_size);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t max_size,
                                                 unsigned seed) {
  using namespace rubric::fuzz;
  if (seed % kCrossOversAsked != 0) return 0;
  const auto made = seeded_mutator(seed).cross_over(kFormat, rubric::Bytes(one, one_size),
                                                    rubric::Bytes(other, other_size), max_size);
  return copy_out(made, 0, out, max_size);
}
