#include "codec/containers/capture_time.h"

namespace rubric {

__extension__ using Wide = __int128;

std::uint64_t ticks_of_resolution(std::uint8_t if_tsresol) {
  const unsigned exponent = if_tsresol & 0x7Fu;
  if ((if_tsresol & 0x80u) != 0) return exponent < 64 ? std::uint64_t{1} << exponent : 0;
  if (exponent > 19) return 0;
  std::uint64_t ticks = 1;
  for (unsigned i = 0; i < exponent; ++i) ticks *= 10;
  return ticks;
}

std::int64_t time_ns_of_ticks(std::uint64_t ticks, const Interface& interface) {
  constexpr Wide kNsPerSecond = 1'000'000'000;
  const Wide rate = interface.ticks_per_second;
  if (rate == 0) return kNoTime;
  const Wide seconds = static_cast<Wide>(ticks) / rate + interface.offset_seconds;
  const Wide ns = seconds * kNsPerSecond + static_cast<Wide>(ticks) % rate * kNsPerSecond / rate;
  if (ns > INT64_MAX || ns <= kNoTime) return kNoTime;
  return static_cast<std::int64_t>(ns);
}

}  // namespace rubric
