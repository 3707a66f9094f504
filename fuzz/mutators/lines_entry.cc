// Entry point for targets whose input is text.
#include "fuzz/mutators/lines_mutator.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return rubric::fuzz::mutate_lines(data, size, max_size, seed);
}
