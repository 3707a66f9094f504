// Checks the values of a number: `valid`, -expect, and the range that they leave.
#include <algorithm>
#include <limits>

#include "spec/compiler/check/check.h"
#include "spec/compiler/check/intervals.h"

namespace rubricc {
namespace {

constexpr std::size_t kOneOfMax = 255;  // reflect::Valid::one_of_count is a byte.

bool fits(Check& check, const Field& field, const SourcePlace& place, std::int64_t value,
          Interval range, std::string_view what) {
  if (value >= range.min && value <= range.max) return true;
  check.error(place, fmt::format("{} {} is beyond {}", what, value, quote(field.id)),
              fmt::format("{} to {} was expected", range.min, range.max));
  return false;
}

void resolve_bound(Check& check, const Field& field, ExprPtr& expr, const Scope& scope,
                   Interval range, std::optional<std::int64_t>& bound, std::string_view what) {
  if (!expr) return;
  if (field.enumeration != nullptr) {
    check.error(expr->place, fmt::format("{} of an enum", what), "any-of or in-enum was expected");
    return;
  }
  const auto value = resolve_constant(check, *expr, field.id, nullptr, scope);
  if (value && fits(check, field, expr->place, *value, range, what)) bound = value;
}

void resolve_set(Check& check, const Field& field, Valid& valid, const Scope& scope,
                 Interval range) {
  for (const std::int64_t value : valid.one_of) {
    fits(check, field, valid.place, value, range, "the valid value");
  }
  for (ExprPtr& expr : valid.one_of_exprs) {
    const auto value = resolve_constant(check, *expr, field.id, field.enumeration, scope);
    if (value && fits(check, field, expr->place, *value, range, "the valid value")) {
      valid.one_of.push_back(*value);
    }
  }
  if (valid.in_enum && field.enumeration == nullptr) {
    check.error(valid.place, "in-enum without an enum", "enum: was expected at the field");
  } else if (valid.in_enum) {
    for (const EnumEntry& entry : field.enumeration->entries) {
      if (entry.value <= range.max) valid.one_of.push_back(entry.value);
    }
  }
  std::sort(valid.one_of.begin(), valid.one_of.end());
  valid.one_of.erase(std::unique(valid.one_of.begin(), valid.one_of.end()), valid.one_of.end());
  if (valid.one_of.size() > kOneOfMax) {
    check.error(valid.place, fmt::format("{} valid values", valid.one_of.size()),
                fmt::format("at most {}, or min and max", kOneOfMax));
  }
}

/// Returns what a range without ends allows; of 8 bytes more than constants can say.
Interval open_range(const Field& field, Interval range) {
  if (field.width_bytes != 8) return range;
  if (field.kind == ValueKind::kUint) return {0, -1};  // The bits of 2^64 - 1.
  return {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()};
}

void resolve_valid(Check& check, Field& field, const Scope& scope) {
  Valid& valid = *field.valid;
  const Interval range = field.range;
  resolve_bound(check, field, valid.min_expr, scope, range, valid.min, "the minimum");
  resolve_bound(check, field, valid.max_expr, scope, range, valid.max, "the maximum");
  if (valid.min_expr || valid.max_expr) {
    const Interval left{valid.min.value_or(range.min), valid.max.value_or(range.max)};
    if (left.min > left.max) {
      check.error(valid.place,
                  fmt::format("the minimum {} is above the maximum {}", left.min, left.max),
                  "no value would be valid");
      return;
    }
    field.range = left;
    const Interval open = open_range(field, range);
    if (!valid.min) valid.min = open.min;
    if (!valid.max) valid.max = open.max;
  }
  resolve_set(check, field, valid, scope, range);
  if (!valid.one_of.empty()) field.range = {valid.one_of.front(), valid.one_of.back()};
}

bool is_valid(const Field& field, std::int64_t value) {
  if (!field.valid) return true;
  const auto& set = field.valid->one_of;
  if (!set.empty()) return std::binary_search(set.begin(), set.end(), value);
  return value >= field.range.min && value <= field.range.max;
}

}  // namespace

void check_values(Check& check, Field& field, const Scope& scope) {
  if (field.kind != ValueKind::kUint && field.kind != ValueKind::kSint) return;
  const Interval width = field.bit_width > 0
                             ? Interval{0, (std::int64_t{1} << field.bit_width) - 1}
                             : width_range(field.width_bytes, field.kind == ValueKind::kSint);
  field.range = width;
  if (field.valid) resolve_valid(check, field, scope);
  if (!field.expect_expr) return;
  const Expr& expr = *field.expect_expr;
  const auto value =
      resolve_constant(check, *field.expect_expr, field.id, field.enumeration, scope);
  if (!value || !fits(check, field, expr.place, *value, width, "the expected value")) return;
  if (!is_valid(field, *value)) {
    check.error(expr.place, fmt::format("the expected value {} is not valid", *value),
                "'valid' refuses it");
  }
  field.expect = value;
}

}  // namespace rubricc
