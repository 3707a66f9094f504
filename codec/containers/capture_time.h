// Time stamps of capture files.
#pragma once

#include <cstdint>

#include "codec/containers/reader.h"

namespace rubric {

/// Returns the resolution of an if_tsresol byte in ticks per second: a power of ten, or of two if
/// the top bit is set. 0 for those beyond what 64 bits can count.
std::uint64_t ticks_of_resolution(std::uint8_t if_tsresol);

/// Returns nanoseconds since the epoch; kNoTime if the interface's resolution is unknown or the
/// time is beyond 64 bits.
std::int64_t time_ns_of_ticks(std::uint64_t ticks, const Interface& interface);

}  // namespace rubric
