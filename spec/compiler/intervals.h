// Interval arithmetic over what fields can hold.
#pragma once

#include <optional>

#include "spec/compiler/model.h"

namespace rubricc {

/// The values of `a op b` for an arithmetic operator; nothing where one could overflow 64 bits.
/// Divisors must not contain zero. Division and remainder round down, as in Kaitai Struct.
std::optional<Interval> combine(ExprOp op, Interval a, Interval b);

std::int64_t floor_div(std::int64_t a, std::int64_t b);
std::int64_t floor_mod(std::int64_t a, std::int64_t b);

/// What a number of that width can hold.
Interval width_range(int width_bytes, bool is_signed);

}  // namespace rubricc
