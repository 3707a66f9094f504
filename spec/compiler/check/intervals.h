// Interval arithmetic over the ranges of fields.
#pragma once

#include <optional>

#include "spec/compiler/model.h"

namespace rubricc {

/// Returns the values of `a op b` for an arithmetic operator; nothing if one could overflow 64
/// bits. Divisors must not contain zero. Division and remainder round down, as in Kaitai Struct.
std::optional<Interval> combine(ExprOp op, Interval a, Interval b);

std::int64_t floor_div(std::int64_t a, std::int64_t b);
std::int64_t floor_mod(std::int64_t a, std::int64_t b);

/// Returns the range of a number of that width.
Interval width_range(int width_bytes, bool is_signed);

}  // namespace rubricc
