// Finds which numbers must be where for a frame to hold a message.
#include "spec/compiler/emit/tables/routes.h"

#include <algorithm>

#include "spec/compiler/check/intervals.h"

namespace rubricc {
namespace {

using Numbers = std::vector<RouteNumber>;

constexpr std::uint32_t kUnbounded = UINT32_MAX;
constexpr std::size_t kRoutesMax = 10'000;  // A few dozen types can chain into very many.

bool is_constant(const Expr& expr) {
  return expr.op != ExprOp::kField && expr.range.min == expr.range.max;
}

bool can_be(const Field& field, std::int64_t value) {
  if (value < field.range.min || value > field.range.max) return false;
  if (!field.valid || field.valid->one_of.empty()) return true;
  const auto& set = field.valid->one_of;
  return std::binary_search(set.begin(), set.end(), value);
}

/// Joins both; returns nothing if they need different values of one number.
std::optional<Numbers> both(std::optional<Numbers> a, const std::optional<Numbers>& b) {
  if (!a || !b) return std::nullopt;
  for (const RouteNumber& one : *b) {
    const auto same = std::find_if(a->begin(), a->end(), [&](const RouteNumber& other) {
      return other.offset == one.offset && other.width_bytes == one.width_bytes;
    });
    if (same == a->end()) {
      a->push_back(one);
    } else if (same->value != one.value) {
      return std::nullopt;
    }
  }
  return a;
}

std::optional<Numbers> solve_sum(const Expr& expr, std::int64_t value, std::int64_t start) {
  const Expr& left = *expr.operands[0];
  const Expr& right = *expr.operands[1];
  if (is_constant(right)) return solve(left, value - right.range.min, start);
  if (is_constant(left)) return solve(right, value - left.range.min, start);
  // A key of two fields: high * factor + low.
  if (left.op != ExprOp::kMul || !is_constant(*left.operands[1])) return std::nullopt;
  const std::int64_t factor = left.operands[1]->range.min;
  if (factor <= 0 || right.range.min < 0 || right.range.max >= factor) return std::nullopt;
  return both(solve(*left.operands[0], floor_div(value, factor), start),
              solve(right, floor_mod(value, factor), start));
}

/// Returns a value other than `value` for the expression.
std::optional<Numbers> solve_other(const Expr& expr, std::int64_t value, std::int64_t start) {
  for (const std::int64_t other : {std::int64_t{0}, value + 1, value - 1}) {
    if (other == value) continue;
    if (auto found = solve(expr, other, start)) return found;
  }
  return std::nullopt;
}

std::optional<Numbers> solve_condition(const Expr& expr, bool wanted, std::int64_t start) {
  const Expr& left = *expr.operands[0];
  if (expr.op == ExprOp::kNot) return solve(left, wanted ? 0 : 1, start);
  const Expr& right = *expr.operands[1];
  if (expr.op == ExprOp::kAnd || expr.op == ExprOp::kOr) {
    const std::int64_t value = wanted ? 1 : 0;
    if ((expr.op == ExprOp::kAnd) == wanted) {
      return both(solve(left, value, start), solve(right, value, start));
    }
    auto found = solve(left, value, start);
    return found ? found : solve(right, value, start);
  }
  if ((expr.op != ExprOp::kEq && expr.op != ExprOp::kNe) || !is_constant(right)) {
    return std::nullopt;
  }
  const bool equal = (expr.op == ExprOp::kEq) == wanted;
  return equal ? solve(left, right.range.min, start) : solve_other(left, right.range.min, start);
}

class Walk {
 public:
  explicit Walk(std::vector<Route>& out) : out_(out) {}

  /// Enters `type` at the end of `here`, and adds its contents.
  void enter(const Type& type, const Route& here) {
    for (const auto& field : type.fields) {
      if (field->choice && field->fixed_offset >= 0) choose(*field, here);
    }
    for (const auto& instance : type.instances) {
      if (!instance->is_peek) choose(*instance, here);
    }
  }

 private:
  void choose(const Field& field, const Route& here) {
    Route at = here;
    at.offset += field.fixed_offset;
    at.room = here.room == kUnbounded ? kUnbounded
                                      : here.room - static_cast<std::uint32_t>(field.fixed_offset);
    if (field.size) add_length(*field.size, here.offset, at);
    if (field.condition) {
      const auto choices = solve(*field.condition, 1, here.offset);
      if (!add(at, choices)) return;
    }
    if (!field.choice) return arrive(*field.type, at);
    for (const SwitchCase& one : field.choice->cases) {
      Route next = at;
      if (add(next, solve(*field.choice->key, one.key, here.offset))) arrive(*one.type, next);
    }
    if (!field.choice->otherwise) return;
    Route next = at;
    if (add(next, solve_rest(*field.choice, here.offset))) {
      arrive(*field.choice->otherwise->type, next);
    }
  }

  void arrive(const Type& type, const Route& at) {
    if (out_.size() >= kRoutesMax) return;
    Route found = at;
    found.type = &type;
    out_.push_back(found);
    enter(type, found);
  }

  static bool add(Route& route, const std::optional<Numbers>& choices) {
    auto merged = both(route.choices, choices);
    if (!merged) return false;
    route.choices = std::move(*merged);
    return true;
  }

  /// Adds a length if the size is one number, plus or minus nothing.
  static void add_length(const Expr& size, std::int64_t start, Route& at) {
    if (size.range.max < at.room) at.room = static_cast<std::uint32_t>(size.range.max);
    if (size.op != ExprOp::kField) return;
    at.lengths.push_back(
        {start + size.offset_bytes, size.field->width_bytes, size.field->little_endian, at.offset});
  }

  /// Returns a key without a case, for `_`.
  static std::optional<Numbers> solve_rest(const Switch& choice, std::int64_t start) {
    const Interval range = choice.key->range;
    for (std::int64_t value = range.min; value <= range.max; ++value) {
      const bool taken = std::any_of(choice.cases.begin(), choice.cases.end(),
                                     [&](const SwitchCase& one) { return one.key == value; });
      if (taken) continue;
      if (auto found = solve(*choice.key, value, start)) return found;
      if (value - range.min > 1000) break;
    }
    return std::nullopt;
  }

  std::vector<Route>& out_;
};

}  // namespace

std::optional<Numbers> solve(const Expr& expr, std::int64_t value, std::int64_t start) {
  switch (expr.op) {
    case ExprOp::kInt:
    case ExprOp::kEnumValue: return expr.value == value ? std::optional(Numbers{}) : std::nullopt;
    case ExprOp::kField:
      if (expr.field->bit_width > 0 || !can_be(*expr.field, value)) return std::nullopt;
      return Numbers{
          {start + expr.offset_bytes, expr.field->width_bytes, expr.field->little_endian, value}};
    case ExprOp::kAdd: return solve_sum(expr, value, start);
    case ExprOp::kSub:
      if (!is_constant(*expr.operands[1])) return std::nullopt;
      return solve(*expr.operands[0], value + expr.operands[1]->range.min, start);
    case ExprOp::kMul: {
      const Expr& factor = *expr.operands[1];
      if (!is_constant(factor) || factor.range.min == 0 ||
          floor_mod(value, factor.range.min) != 0) {
        return std::nullopt;
      }
      return solve(*expr.operands[0], floor_div(value, factor.range.min), start);
    }
    case ExprOp::kDiv:
    case ExprOp::kMod:
    case ExprOp::kSelect: return std::nullopt;
    default: return solve_condition(expr, value != 0, start);
  }
}

std::vector<Route> routes_of(const Spec& spec) {
  std::vector<Route> out;
  for (const auto& type : spec.types) {
    if (type->carrier.empty()) continue;
    Route start{.carrier = type->carrier, .type = type.get(), .room = type->max_size};
    Walk(out).enter(*type, start);
  }
  return out;
}

}  // namespace rubricc
