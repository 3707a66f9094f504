// Changes text as a person's slip would: doubles, drops or swaps whole lines, and swaps words and
// values. For targets whose input is text: an engine that knows only bytes breaks the text's outer
// form first and seldom reaches the meaning of its words.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rubric::fuzz {

/// Changes data[0, size) in place by a few slips, or now and then as mutate_bytes() does, and
/// returns the new size, at most `max_size`.
std::size_t mutate_lines(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed);

}  // namespace rubric::fuzz
