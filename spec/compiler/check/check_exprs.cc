// Resolves expressions: their names, their result types, and their ranges.
#include <algorithm>
#include <optional>
#include <span>

#include "spec/compiler/check/check.h"
#include "spec/compiler/check/intervals.h"
#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

constexpr int kStackMax = 8;       // kMaxExprDepth of codec/reflect/schema.h.
constexpr int kStepsMax = 255;     // reflect::Expr::count is a byte.
constexpr int kExpandedMax = 100;  // Computed instances of one expression.
constexpr Interval kConstants{-2147483648LL, 2147483647LL};

ExprShape open() { return {}; }

/// The cost of evaluating: values on the stack and steps in postfix order.
struct Cost {
  int stack = 1;
  int steps = 1;
};
Cost cost(const Expr& expr) {
  if (expr.field != nullptr && expr.field->bit_width > 0) {
    return {2, 4 * expr.field->width_bytes + 1};  // As append_bits of built_tables.cc has it.
  }
  Cost out{0, 1};
  int held = 0;
  for (const auto& operand : expr.operands) {
    const Cost one = cost(*operand);
    out.stack = std::max(out.stack, held + one.stack);
    out.steps += one.steps;
    ++held;
  }
  out.stack = std::max(out.stack, 1);
  return out;
}

class Resolver {
 public:
  Resolver(Check& check, const Scope& scope) : check_(check), scope_(scope) {}

  ExprShape resolve(Expr& expr) {
    switch (expr.op) {
      case ExprOp::kInt: return number(expr);
      case ExprOp::kField: return field(expr);
      case ExprOp::kEnumValue: return enum_value(expr);
      case ExprOp::kNot: return logic(expr);
      case ExprOp::kAnd:
      case ExprOp::kOr: return logic(expr);
      case ExprOp::kEq:
      case ExprOp::kNe:
      case ExprOp::kLt:
      case ExprOp::kLe:
      case ExprOp::kGt:
      case ExprOp::kGe: return comparison(expr);
      case ExprOp::kSelect: return choice(expr);
      default: return arithmetic(expr);
    }
  }

 private:
  ExprShape number(Expr& expr) {
    return constant(expr, {expr.is_bool ? Shape::kBool : Shape::kInt, nullptr});
  }

  ExprShape constant(Expr& expr, ExprShape shape) {
    if (!scope_.wide && (expr.value < kConstants.min || expr.value > kConstants.max)) {
      check_.error(expr.place, fmt::format("{} is beyond 32 bits", expr.value),
                   "constants of expressions are signed 32-bit numbers");
      return open();
    }
    expr.range = {expr.value, expr.value};
    return shape;
  }

  ExprShape enum_value(Expr& expr) {
    const Enum* found = find_enum(*scope_.type.spec, expr.path);
    if (found == nullptr) {
      check_.error(expr.place, fmt::format("unknown enum in {}", quote(to_text(expr))),
                   suggestion(expr.path[expr.path.size() - 2], ids_of(scope_.type.spec->enums)));
      return open();
    }
    for (const EnumEntry& entry : found->entries) {
      if (entry.name != expr.path.back()) continue;
      expr.value = entry.value;
      return constant(expr,
                      expr.to_i ? ExprShape{Shape::kInt, nullptr} : ExprShape{Shape::kEnum, found});
    }
    std::vector<std::string> known;
    for (const EnumEntry& entry : found->entries) known.push_back(entry.name);
    check_.error(expr.place, fmt::format("unknown enum value {}", quote(to_text(expr))),
                 suggestion(expr.path.back(), known));
    return open();
  }

  /// Returns the field that the path begins with, or null after an error.
  const Field* head(const Expr& expr) {
    const std::string& name = expr.path[0];
    if (scope_.wide) {
      check_.error(expr.place, fmt::format("{} is not a constant", quote(to_text(expr))),
                   "a number or an enum::value was expected");
      return nullptr;
    }
    if (scope_.element != nullptr || name == "_") {
      check_.error(expr.place, fmt::format("{} is outside the profile", quote(to_text(expr))),
                   scope_.element != nullptr ? "the element, '_', and parameters can be read here"
                                             : "fields of the same structure can be read");
      return nullptr;
    }
    const auto& fields = scope_.type.fields;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (fields[i]->id != name) continue;
      if (i < scope_.fields_before) return fields[i].get();
      check_.error(expr.place, fmt::format("field {} is used before it is read", quote(name)),
                   "only fields further up are known here");
      return nullptr;
    }
    for (const auto& instance : scope_.type.instances) {
      if (instance->id != name) continue;
      if (instance->is_peek && scope_.peeks) return instance.get();
      check_.error(expr.place, fmt::format("instance {} cannot be read here", quote(name)),
                   "only instances read peeks");
      return nullptr;
    }
    const std::span before(fields.data(), scope_.fields_before);
    check_.error(expr.place, fmt::format("unknown field {}", quote(name)),
                 suggestion(name, ids_of(before)));
    return nullptr;
  }

  static int index_of(const Field& field, const Type& type) {
    const auto& fields = type.fields;
    const auto is_it = [&](const auto& one) { return one.get() == &field; };
    return static_cast<int>(std::find_if(fields.begin(), fields.end(), is_it) - fields.begin());
  }

  const Field* inner(const Expr& expr, const Field& outer, const std::string& name) {
    if (outer.kind != ValueKind::kStruct || outer.choice) {
      check_.error(expr.place, fmt::format("{} has no fields to read", quote(outer.id)),
                   outer.choice ? "its type depends on a switch" : "it is not a structure");
      return nullptr;
    }
    if (outer.extent != ExtentKind::kOwn) {
      check_.error(expr.place, fmt::format("the fields of {} cannot be read", quote(outer.id)),
                   "a size delimits it; a structure without one was expected");
      return nullptr;
    }
    for (const auto& field : outer.type->fields) {
      if (field->id == name) return field.get();
    }
    check_.error(expr.place,
                 fmt::format("unknown field {} of {}", quote(name), quote(outer.type->id)),
                 suggestion(name, ids_of(outer.type->fields)));
    return nullptr;
  }

  /// Returns whether the field that is the whole path may be at a place that differs from frame to
  /// frame, and is looked for in each. Carriers are told apart by constant places.
  bool may_float(const Expr& expr) const {
    const std::size_t names = scope_.element == nullptr ? 1 : 2;
    return check_.at_run_time && expr.path.size() == names && !scope_.peeks &&
           scope_.type.carrier.empty();
  }

  /// Returns whether `step` is where expressions can read it.
  bool is_fixed(const Expr& expr, const Field& step) {
    const std::string what = quote(to_text(expr));
    if (step.repeat != RepeatKind::kOnce) {
      check_.error(expr.place, fmt::format("{} is a list", what), "a single number was expected");
    } else if (step.condition && !may_float(expr)) {
      check_.error(expr.place, fmt::format("{} may be absent", what),
                   "a field without 'if' was expected");
    } else if (step.fixed_offset < 0 && !may_float(expr)) {
      check_.error(expr.place, fmt::format("{} is at no constant position", what),
                   "what comes before it must have a constant size");
    } else {
      return true;
    }
    return false;
  }

  std::optional<ExprShape> param(Expr& expr) {
    const auto& params = scope_.type.params;
    for (std::size_t i = 0; !scope_.wide && i < params.size(); ++i) {
      if (params[i].id != expr.path[0]) continue;
      if (expr.path.size() > 1) {
        check_.error(expr.place, fmt::format("{} has no fields to read", quote(expr.path[0])),
                     "it is a parameter");
        return open();
      }
      expr.param = static_cast<int>(i);
      expr.range = params[i].range;
      const Enum* const names = expr.to_i ? nullptr : params[i].enumeration;
      if (params[i].is_bool && !expr.to_i) return ExprShape{Shape::kBool, nullptr};
      return ExprShape{names == nullptr ? Shape::kInt : Shape::kEnum, names};
    }
    return std::nullopt;
  }

  /// Returns the computed instance that the path leads to, or null.
  const Computed* computed_of(const Expr& expr) const {
    const Type* owner = &scope_.type;
    std::size_t at = 0;
    if (scope_.wide) return nullptr;
    if (scope_.element != nullptr) {
      if (expr.path[at++] != "_") return nullptr;
      owner = scope_.element->type;
    }
    for (; owner != nullptr && at < expr.path.size(); ++at) {
      const auto is_it = [&](const auto& one) { return one->id == expr.path[at]; };
      if (at + 1 == expr.path.size()) {
        // Names within it are those of its own file.
        if (owner->spec != scope_.type.spec) return nullptr;
        for (const Computed& one : owner->computed) {
          if (one.id == expr.path[at]) return &one;
        }
        return nullptr;
      }
      const auto found = std::find_if(owner->fields.begin(), owner->fields.end(), is_it);
      if (found == owner->fields.end()) return nullptr;
      owner = (*found)->type;
    }
    return nullptr;
  }

  static void put_before(const std::vector<std::string>& path, Expr& expr) {
    if (expr.op == ExprOp::kField) expr.path.insert(expr.path.begin(), path.begin(), path.end());
    for (const auto& operand : expr.operands) put_before(path, *operand);
  }

  /// Puts what a computed instance is computed from in place of it.
  ExprShape computed(Expr& expr, const Computed& one) {
    if (one.text.empty()) {
      check_.error(expr.place, fmt::format("instance {} cannot be read here", quote(one.id)),
                   "it has no value that is always there");
      return open();
    }
    if (++expanded_ > kExpandedMax) {
      check_.error(expr.place, fmt::format("instance {} takes too many others", quote(one.id)),
                   "or is computed from itself");
      return open();
    }
    const ExprPtr tree = parse_expr(one.text, one.place, check_.diagnostics);
    if (!tree) return open();
    put_before({expr.path.begin(), expr.path.end() - 1}, *tree);
    ExprShape shape = resolve(*tree);
    if (shape.shape == Shape::kOpen) return shape;
    if (shape.shape == Shape::kInt && !one.enum_name.empty()) {
      shape = {Shape::kEnum, find_enum(*scope_.type.spec, one.enum_name)};
      if (shape.enumeration == nullptr) {
        check_.error(one.place, fmt::format("unknown enum {}", quote(one.enum_name)),
                     suggestion(one.enum_name, ids_of(scope_.type.spec->enums)));
        return open();
      }
    }
    if (expr.to_i && shape.shape == Shape::kEnum) shape = {Shape::kInt, nullptr};
    tree->place = expr.place;
    expr = std::move(*tree);
    return shape;
  }

  ExprShape field(Expr& expr) {
    if (const auto found = param(expr)) return *found;
    if (const Computed* found = computed_of(expr)) return computed(expr, *found);
    const bool of_element = scope_.element != nullptr && expr.path[0] == "_";
    const Field* step = of_element ? scope_.element : head(expr);
    const Type& owner = of_element && step->type != nullptr ? *step->type : scope_.type;
    std::int64_t offset = 0;
    for (std::size_t i = 0; step != nullptr; ++i) {
      if (of_element && i == 0) {  // The list, which begins where the element does.
        expr.steps.push_back(step);
        if (expr.path.size() == 1) break;
        step = inner(expr, *step, expr.path[1]);
        continue;
      }
      if (check_.is_open(step)) return open();
      if (!is_fixed(expr, *step)) return open();
      if (step->fixed_offset < 0 || step->condition) {
        expr.from = index_of(*step, owner);
      } else {
        offset += step->fixed_offset;
      }
      expr.steps.push_back(step);
      if (i + 1 == expr.path.size()) break;
      step = inner(expr, *step, expr.path[i + 1]);
    }
    if (step == nullptr) return open();
    if (step->kind != ValueKind::kUint) {
      check_.error(expr.place,
                   fmt::format("{} cannot be read in an expression", quote(to_text(expr))),
                   "an unsigned number was expected");
      return open();
    }
    if (step->width_bytes == 8) {
      check_.error(expr.place, fmt::format("{} has 64 bits", quote(to_text(expr))),
                   "expressions read numbers of at most 32");
      return open();
    }
    expr.field = step;
    expr.offset_bytes = offset;
    expr.range = step->range;
    if (step->condition) {
      check_.diagnostics.note(expr.place, quote(to_text(expr)) + " may be absent, and is 0 then");
      expr.range.min = std::min<std::int64_t>(expr.range.min, 0);
    }
    if (step->bit_width == 1 && !expr.to_i && step->enumeration == nullptr) {
      return {Shape::kBool, nullptr};
    }
    const bool is_enum = step->enumeration != nullptr && !expr.to_i;
    return is_enum ? ExprShape{Shape::kEnum, step->enumeration} : ExprShape{Shape::kInt, nullptr};
  }

  bool wants(const Expr& operand, ExprShape found, Shape shape, std::string_view expected) {
    if (found.shape == shape) return true;
    if (found.shape != Shape::kOpen) {
      check_.error(operand.place, fmt::format("{} does not fit here", quote(to_text(operand))),
                   expected);
    }
    return false;
  }

  ExprShape logic(Expr& expr) {
    bool ok = true;
    for (const auto& operand : expr.operands) {
      ok &= wants(*operand, resolve(*operand), Shape::kBool, "a comparison was expected");
    }
    expr.range = {0, 1};
    return ok ? ExprShape{Shape::kBool, nullptr} : open();
  }

  ExprShape comparison(Expr& expr) {
    const ExprShape left = resolve(*expr.operands[0]);
    const ExprShape right = resolve(*expr.operands[1]);
    expr.range = {0, 1};
    if (left.shape == Shape::kOpen || right.shape == Shape::kOpen) return open();
    const bool ordered = expr.op != ExprOp::kEq && expr.op != ExprOp::kNe;
    const bool same = left.shape == right.shape && left.enumeration == right.enumeration;
    const bool told = expr.operands[0]->is_bool || expr.operands[1]->is_bool;
    const bool conditions = left.shape == Shape::kBool && (ordered || !told);
    if (!same || conditions || (ordered && left.shape == Shape::kEnum)) {
      check_.error(expr.place,
                   fmt::format("{} and {} cannot be compared", quote(to_text(*expr.operands[0])),
                               quote(to_text(*expr.operands[1]))),
                   "two numbers, or a field and a value of its enum; .to_i makes a number");
      return open();
    }
    return {Shape::kBool, nullptr};
  }

  ExprShape choice(Expr& expr) {
    const Expr& condition = *expr.operands[0];
    const bool told =
        wants(condition, resolve(*expr.operands[0]), Shape::kBool, "a condition was expected");
    const ExprShape left = resolve(*expr.operands[1]);
    const ExprShape right = resolve(*expr.operands[2]);
    if (!told || left.shape == Shape::kOpen || right.shape == Shape::kOpen) return open();
    if (left.shape != right.shape || left.enumeration != right.enumeration) {
      check_.error(expr.place, fmt::format("{} has values of two kinds", quote(to_text(expr))),
                   "two numbers, or two values of one enum were expected");
      return open();
    }
    const Interval a = expr.operands[1]->range;
    const Interval b = expr.operands[2]->range;
    expr.range = {std::min(a.min, b.min), std::max(a.max, b.max)};
    return left;
  }

  ExprShape arithmetic(Expr& expr) {
    bool ok = true;
    for (const auto& operand : expr.operands) {
      ok &= wants(*operand, resolve(*operand), Shape::kInt,
                  "a number was expected; .to_i makes one of an enum");
    }
    if (!ok) return open();
    const Interval a = expr.operands[0]->range;
    const Interval b = expr.operands[1]->range;
    if ((expr.op == ExprOp::kDiv || expr.op == ExprOp::kMod) && b.min <= 0 && b.max >= 0) {
      check_.error(expr.place, fmt::format("{} can be zero", quote(to_text(*expr.operands[1]))),
                   "a divisor that is never zero was expected");
      return open();
    }
    const auto range = combine(expr.op, a, b);
    if (!range && expr.op >= ExprOp::kBitAnd) {
      check_.error(expr.place, fmt::format("{} can be beyond 32 bits", quote(to_text(expr))),
                   "operators on bits take and make 0 to 4294967295");
      return open();
    }
    if (!range) {
      check_.error(expr.place, fmt::format("{} can overflow 64 bits", quote(to_text(expr))),
                   "smaller numbers were expected");
      return open();
    }
    expr.range = *range;
    return {Shape::kInt, nullptr};
  }

  Check& check_;
  const Scope& scope_;
  int expanded_ = 0;
};

}  // namespace

ExprShape resolve_expr(Check& check, Expr& expr, const Scope& scope) {
  const ExprShape shape = Resolver(check, scope).resolve(expr);
  if (shape.shape == Shape::kOpen) return shape;
  const Cost needed = cost(expr);
  if (needed.stack > kStackMax || needed.steps > kStepsMax) {
    check.error(expr.place, "the expression is too deep to evaluate",
                fmt::format("at most {} values are kept", kStackMax));
    return {};
  }
  return shape;
}

std::optional<std::int64_t> resolve_constant(Check& check, Expr& expr, std::string_view what,
                                             const Enum* enumeration, const Scope& scope) {
  const ExprShape found = resolve_expr(check, expr, {scope.type, 0, false, true});
  if (found.shape == Shape::kOpen) return std::nullopt;
  if (expr.is_bool && enumeration == nullptr) return expr.value;
  const Shape wanted = enumeration == nullptr ? Shape::kInt : Shape::kEnum;
  if (found.shape == wanted && found.enumeration == enumeration) return expr.range.min;
  check.error(expr.place, fmt::format("{} does not fit {}", quote(to_text(expr)), quote(what)),
              enumeration == nullptr
                  ? std::string("a number was expected")
                  : fmt::format("a value of {}:: was expected", enumeration->id));
  return std::nullopt;
}

}  // namespace rubricc
