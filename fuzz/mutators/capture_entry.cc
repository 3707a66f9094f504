// Entry points for targets whose input is a stream or file of one format, RUBRIC_FUZZ_FORMAT, or,
// without that, a capture of any format, recognized by its content, or a log. Input of no known
// format becomes a capture file, which can hold anything.
#include "codec/containers/reader.h"
#include "fuzz/mutators/entry.h"
#include "fuzz/mutators/lines_mutator.h"

namespace {

using namespace rubric;

#ifdef RUBRIC_FUZZ_FORMAT
InputFormat format_of(Bytes) { return InputFormat::RUBRIC_FUZZ_FORMAT; }

bool is_log(const std::uint8_t*, std::size_t) { return false; }
#else
InputFormat format_of(Bytes input) {
  const InputFormat format = detect(input);
  const bool readable = format != InputFormat::kUnknown && format != InputFormat::kJsonl;
  return readable ? format : InputFormat::kPcapng;
}

bool is_log(const std::uint8_t* data, std::size_t size) { return size > 0 && data[0] == '%'; }
#endif

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  if (is_log(data, size)) return fuzz::mutate_lines(data, size, max_size, seed);
  const Bytes input(data, size);
  const auto made = fuzz::seeded_mutator(seed).mutate(format_of(input), input, max_size);
  return fuzz::copy_out(made, 0, data, max_size);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t max_size,
                                                 unsigned seed) {
  if (seed % fuzz::kCrossOversAsked != 0) return 0;
  const Bytes first(one, one_size);
  const Bytes second(other, other_size);
  const InputFormat format = format_of(first);
  if (format != format_of(second)) return 0;
  return fuzz::copy_out(fuzz::seeded_mutator(seed).cross_over(format, first, second, max_size), 0,
                        out, max_size);
}
