// Chance as the networks of lawful traffic draw it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codec/frame_generator/random.h"

namespace rubric::lawful {

class Random : public generate::Random {
 public:
  using generate::Random::Random;

  bool chance(int percent) { return below(100) < static_cast<std::size_t>(percent); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(next() >> 32); }
  std::uint16_t number16() { return static_cast<std::uint16_t>(next() >> 32); }
};

}  // namespace rubric::lawful
