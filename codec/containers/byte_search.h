// Finds and undoes escapes of the serial line, many bytes a step.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codec/containers/cpu.h"

namespace rubric {

/// Returns the first flag or escape (0x7E or 0x7D) in [begin, end), or `end`.
const std::uint8_t* find_special_portable(const std::uint8_t* begin, const std::uint8_t* end);
/// Does the same eight bytes at a time, without any vector instruction.
const std::uint8_t* find_special_swar(const std::uint8_t* begin, const std::uint8_t* end);
/// Does the same by AVX2 and AVX-512; only if cpu_has() the path.
const std::uint8_t* find_special_vector(const std::uint8_t* begin, const std::uint8_t* end);
const std::uint8_t* find_special_wide(const std::uint8_t* begin, const std::uint8_t* end);

/// The most bytes that unescape writes beyond those that it returns.
inline constexpr std::size_t kUnescapeSlack = 32;

/// Copies [begin, end), which holds no flag, to `out` and undoes its escapes; returns the end of
/// its output. Sets `*dangling` if the last byte was an escape whose second byte is yet to come
/// (never written). `out` has room for end - begin + kUnescapeSlack bytes.
std::uint8_t* unescape_portable(const std::uint8_t* begin, const std::uint8_t* end,
                                std::uint8_t* out, bool* dangling);
std::uint8_t* unescape_vector(const std::uint8_t* begin, const std::uint8_t* end, std::uint8_t* out,
                              bool* dangling);

}  // namespace rubric
