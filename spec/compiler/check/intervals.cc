// Arithmetic of ranges, in 128 bits to detect overflow.
#include "spec/compiler/check/intervals.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace rubricc {
namespace {

__extension__ typedef __int128 Wide;

constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();

Wide wide_floor_div(Wide a, Wide b) {
  const Wide quotient = a / b;
  return a % b != 0 && (a < 0) != (b < 0) ? quotient - 1 : quotient;
}

std::optional<Interval> narrow(Wide min, Wide max) {
  if (min < kMin || max > kMax) return std::nullopt;
  return Interval{static_cast<std::int64_t>(min), static_cast<std::int64_t>(max)};
}

std::optional<Interval> corners(Interval a, Interval b, Wide (*apply)(Wide, Wide)) {
  const std::array<Wide, 4> all{apply(a.min, b.min), apply(a.min, b.max), apply(a.max, b.min),
                                apply(a.max, b.max)};
  return narrow(*std::min_element(all.begin(), all.end()),
                *std::max_element(all.begin(), all.end()));
}

Interval remainder(Interval a, Interval b) {
  if (b.min > 0) {
    const bool unchanged = a.min >= 0 && a.max < b.min;
    if (unchanged) return a;
    return {0, a.min >= 0 ? std::min(a.max, b.max - 1) : b.max - 1};
  }
  return {b.min + 1, 0};
}

constexpr std::int64_t kBitsMost = 0xFFFFFFFF;
bool has_32_bits(Interval range) { return range.min >= 0 && range.max <= kBitsMost; }

// Operands and results of operators on bits have 32 of them, so that all languages agree.
std::optional<Interval> on_bits(ExprOp op, Interval a, Interval b) {
  if (!has_32_bits(a) || !has_32_bits(b)) return std::nullopt;
  const bool known = a.min == a.max && b.min == b.max;
  const auto any = static_cast<std::int64_t>(
      std::bit_ceil(static_cast<std::uint64_t>(std::max(a.max, b.max)) + 1) - 1);
  switch (op) {
    case ExprOp::kBitAnd:
      return known ? Interval{a.min & b.min, a.min & b.min} : Interval{0, std::min(a.max, b.max)};
    case ExprOp::kBitOr:
      return known ? Interval{a.min | b.min, a.min | b.min} : Interval{std::max(a.min, b.min), any};
    case ExprOp::kBitXor: return known ? Interval{a.min ^ b.min, a.min ^ b.min} : Interval{0, any};
    default: break;
  }
  if (b.max > 31) return std::nullopt;
  if (op == ExprOp::kShiftRight) return Interval{a.min >> b.max, a.max >> b.min};
  const Interval out{a.min << b.min, a.max << b.max};
  return has_32_bits(out) ? std::optional(out) : std::nullopt;
}

}  // namespace

std::optional<Interval> combine(ExprOp op, Interval a, Interval b) {
  switch (op) {
    case ExprOp::kAdd: return narrow(Wide{a.min} + b.min, Wide{a.max} + b.max);
    case ExprOp::kSub: return narrow(Wide{a.min} - b.max, Wide{a.max} - b.min);
    case ExprOp::kMul: return corners(a, b, [](Wide x, Wide y) { return x * y; });
    case ExprOp::kDiv: return corners(a, b, wide_floor_div);
    case ExprOp::kMod: return remainder(a, b);
    case ExprOp::kBitAnd:
    case ExprOp::kBitOr:
    case ExprOp::kBitXor:
    case ExprOp::kShiftLeft:
    case ExprOp::kShiftRight: return on_bits(op, a, b);
    default: return Interval{0, 1};
  }
}

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(wide_floor_div(a, b));
}

std::int64_t floor_mod(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(Wide{a} - wide_floor_div(a, b) * b);
}

Interval width_range(int width_bytes, bool is_signed) {
  // Of 8 bytes those that a dissector's numbers, which are doubles, tell from all others.
  const std::int64_t span = std::int64_t{1} << std::min(8 * width_bytes, 53);
  if (is_signed) return {-span / 2, span / 2 - 1};
  return {0, span - 1};
}

}  // namespace rubricc
