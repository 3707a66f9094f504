#include "fuzz/support/mutate_bytes.h"

#include <algorithm>
#include <cstring>
#include <random>

// Only libFuzzer has it.
extern "C" __attribute__((weak)) std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size,
                                                              std::size_t max_size);

namespace rubric::fuzz {
namespace {

std::size_t change_one(std::uint8_t* data, std::size_t size, std::size_t max_size,
                       std::minstd_rand& random) {
  const std::size_t at = size == 0 ? 0 : random() % size;
  switch (random() % 4) {
    case 0:
      if (size == max_size) return size;
      std::memmove(data + at + 1, data + at, size - at);
      data[at] = static_cast<std::uint8_t>(random());
      return size + 1;
    case 1:
      if (size == 0) return size;
      std::memmove(data + at, data + at + 1, size - at - 1);
      return size - 1;
    case 2:
      if (size > 0) data[at] = static_cast<std::uint8_t>(random());
      return size;
    default:
      if (size > 0) data[at] = static_cast<std::uint8_t>(data[at] ^ (1u << random() % 8));
      return size;
  }
}

}  // namespace

std::size_t mutate_bytes(std::uint8_t* data, std::size_t size, std::size_t max_size,
                         unsigned seed) {
  if (max_size == 0) return 0;
  if (LLVMFuzzerMutate != nullptr) return LLVMFuzzerMutate(data, size, max_size);
  std::minstd_rand random(seed);
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    size = change_one(data, std::min(size, max_size), max_size, random);
  }
  return size;
}

}  // namespace rubric::fuzz
