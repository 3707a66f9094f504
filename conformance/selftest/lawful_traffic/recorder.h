// Records lawful traffic as real recorders do: with wrong stamps and missing packets. The
// nodes stay honest.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "conformance/selftest/lawful_traffic/random.h"
#include "conformance/selftest/lawful_traffic/traffic.h"

namespace rubric::lawful {

/// A way to record. Packets keep the order in which they came, whatever their stamps say.
struct Recorder {
  std::string_view name;
  std::string_view summary;
  void (*record)(Traffic& traffic, Random& random);
};

/// Returns all recorders; the first one is exact.
std::span<const Recorder> recorders();

/// Records `traffic` in the way of that name. The same seed makes the same changes. Throws
/// std::invalid_argument for another name.
void record(Traffic& traffic, std::string_view recorder, std::uint64_t seed);

}  // namespace rubric::lawful
