// The engine's own mutation of bytes, as a fallback of the structure-aware mutators.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rubric::fuzz {

/// Changes data[0, size) in place and returns the new size, at most `max_size`. Uses libFuzzer if
/// it is linked; else, under AFL++ or in a replay, makes a few random changes from `seed`.
std::size_t mutate_bytes(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed);

}  // namespace rubric::fuzz
