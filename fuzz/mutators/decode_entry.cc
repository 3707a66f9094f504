// Entry points for decode_fuzz, whose input has its format in a head of two bytes.
#include "fuzz/mutators/entry.h"
#include "fuzz/support/decode_input.h"
#include "fuzz/support/mutate_bytes.h"

namespace {

using namespace rubric;

constexpr std::size_t kHead = fuzz::DecodeInput::kHeadBytes;

InputFormat format_of(const std::uint8_t* data, std::size_t size) {
  const InputFormat format = fuzz::read_decode_input(data, size).format;
  const bool readable = format != InputFormat::kUnknown && format != InputFormat::kJsonl;
  return readable ? format : InputFormat::kHdlc;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  fuzz::PacketMutator& mutator = fuzz::seeded_mutator(seed);
  if (max_size <= kHead) return fuzz::mutate_bytes(data, size, max_size, seed);
  if (size < kHead || mutator.random().below(32) == 0) {
    // Pads the head with zeros, which reads the same.
    for (; size < kHead; ++size) data[size] = 0;
    data[0] = static_cast<std::uint8_t>(mutator.random().below(64));
    data[1] = static_cast<std::uint8_t>(mutator.random().below(256));
    return size;
  }
  const Bytes input(data + kHead, size - kHead);
  return fuzz::copy_out(mutator.mutate(format_of(data, size), input, max_size - kHead), kHead, data,
                        max_size);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t max_size,
                                                 unsigned seed) {
  if (seed % fuzz::kCrossOversAsked != 0) return 0;
  if (one_size < kHead || other_size < kHead || max_size <= kHead) return 0;
  const InputFormat format = format_of(one, one_size);
  if (format != format_of(other, other_size)) return 0;
  std::copy_n(one, kHead, out);
  const auto made = fuzz::seeded_mutator(seed).cross_over(
      format, Bytes(one + kHead, one_size - kHead), Bytes(other + kHead, other_size - kHead),
      max_size - kHead);
  return fuzz::copy_out(made, kHead, out, max_size);
}
