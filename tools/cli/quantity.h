// Sizes and times as options take them: 100M, 24h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rubric::cli {

/// A size or a time; the other is 0.
struct Quantity {
  std::uint64_t bytes = 0;
  std::uint64_t seconds = 0;
};

/// Reads a whole number from 1 to 1,000,000 and its unit: k, M or G bytes (powers of 1024), s, min,
/// h or d.
std::optional<Quantity> parse_quantity(const std::string& text);

}  // namespace rubric::cli
