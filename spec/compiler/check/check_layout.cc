// Orders types so that contained ones come first, as no type contains itself, and computes sizes
// and offsets in that order.

#include <algorithm>
#include <map>

#include "spec/compiler/check/check.h"
#include "spec/compiler/check/intervals.h"
#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

struct Size {
  std::uint32_t min = 0;
  std::uint32_t max = 0;
};

std::uint32_t bounded(std::uint64_t value) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(value, kUnbounded));
}
std::uint32_t times(std::uint32_t size, std::int64_t count) {
  if (size == kUnbounded && count > 0) return kUnbounded;
  return bounded(std::uint64_t{size} *
                 static_cast<std::uint64_t>(std::min<std::int64_t>(count, kUnbounded)));
}
std::uint32_t plus(std::uint32_t a, std::uint32_t b) { return bounded(std::uint64_t{a} + b); }

class Layout {
 public:
  Layout(Check& check, Type& type) : check_(check), type_(type) {}

  void run() {
    if (!type_.params.empty()) check_params();
    for (std::size_t i = 0; i < type_.fields.size(); ++i) {
      Field& field = *type_.fields[i];
      if (field.bit_width == 0 || field.places.contains("contents")) end_bits(i);
      if (field.bit_width > 0) lay_bits(field);
      place(field, i);
    }
    end_bits(type_.fields.size());
    if (is_open_) check_.open.insert(&type_);
    if (!is_open_) check_declared();
  }

 private:
  void check_params() {
    const SourcePlace& place = place_of(type_.places, "params", type_.place);
    if (!check_.at_run_time) {
      check_.error(
          place, fmt::format("type {} has parameters", quote(type_.id)),
          "fields were expected, by which alone its size is known; rubric --spec reads it");
    }
    if (!type_.am_types.empty() || !type_.carrier.empty()) {
      check_.error(place, fmt::format("parameters of a message or frame, {}", quote(type_.id)),
                   "nothing says what they are");
    }
  }

  bool last(std::size_t index) const { return index + 1 == type_.fields.size(); }

  /// Finds the bytes that a field of bits lies in, and its place within them.
  void lay_bits(Field& field) {
    const int begin = bits_ % 8;
    field.width_bytes = (begin + field.bit_width + 7) / 8;
    field.bit_shift = field.little_endian ? begin : 8 * field.width_bytes - begin - field.bit_width;
    bits_ += field.bit_width;
    if (field.width_bytes <= 4) return;
    check_.error(field.place, fmt::format("the bits {} lie in five bytes", quote(field.id)),
                 "at most four are read as one number");
    field.width_bytes = 4;
  }

  /// Checks that the bits before field `index` fill their bytes.
  void end_bits(std::size_t index) {
    if (bits_ % 8 != 0) {
      const Field& last = *type_.fields[index - 1];
      check_.error(last.place, fmt::format("the bits {} end within a byte", quote(last.id)),
                   fmt::format("{} more were expected", 8 - bits_ % 8));
    }
    bits_ = 0;
  }

  void place(Field& field, std::size_t index) {
    const Scope scope{type_, index};
    if (is_open_) check_.open.insert(&field);
    check_field_shape(check_, field);
    check_values(check_, field, scope);
    const bool conditional = resolve_condition(field, scope);
    field.fixed_offset = offset_ < 0 ? -1 : offset_ - field.shared_bytes();
    if (field.choice) check_switch(check_, *field.choice, field, scope);
    const bool extent_ok = resolve_number(field, field.size, scope, "size");
    const bool count_ok = resolve_number(field, field.count, scope, "count");
    resolve_until(field, scope);
    if (field.kind == ValueKind::kStruct) resolve_calls(check_, field, scope);
    check_last(field, index);
    if (!extent_ok || !count_ok || check_.is_open(&field) || is_type_open(field)) {
      // Later fields have an unknown place: report nothing about them.
      check_.open.insert(&field);
      is_open_ = true;
    } else {
      measure(field, index, conditional);
    }
  }

  bool is_type_open(const Field& field) const {
    if (field.type != nullptr && check_.is_open(field.type)) return true;
    if (!field.choice) return false;
    const auto open = [&](const SwitchCase& one) { return check_.is_open(one.type); };
    return std::any_of(field.choice->cases.begin(), field.choice->cases.end(), open) ||
           (field.choice->otherwise && open(*field.choice->otherwise));
  }

  bool resolve_condition(Field& field, const Scope& scope) {
    if (!field.condition) return false;
    const ExprShape found = resolve_expr(check_, *field.condition, scope);
    if (found.shape != Shape::kBool && found.shape != Shape::kOpen) {
      check_.error(field.condition->place, "'if' is not a condition", "a comparison was expected");
    }
    return true;
  }

  void resolve_until(const Field& field, Scope scope) {
    if (!field.until || check_.is_open(&field) || is_type_open(field)) return;
    scope.element = &field;
    const ExprShape found = resolve_expr(check_, *field.until, scope);
    if (found.shape == Shape::kBool) return;
    check_.open.insert(&field);
    if (found.shape == Shape::kOpen) return;
    check_.error(field.until->place, "'repeat-until' is not a condition",
                 "a comparison was expected");
  }

  /// Resolves a size or a count: a number that is never negative.
  bool resolve_number(Field& field, ExprPtr& expr, const Scope& scope, std::string_view what) {
    if (!expr)
      return what == "size" ? field.extent != ExtentKind::kSize
                            : field.repeat != RepeatKind::kCount;
    const ExprShape found = resolve_expr(check_, *expr, scope);
    if (found.shape == Shape::kOpen) return false;
    if (found.shape != Shape::kInt) {
      check_.error(expr->place,
                   fmt::format("a {} that is not a number: {}", what, quote(to_text(*expr))),
                   "a number was expected; .to_i makes one of an enum");
      return false;
    }
    if (expr->range.max < 0) {
      check_.error(expr->place,
                   fmt::format("the {} {} is always negative", what, quote(to_text(*expr))),
                   "a field has bytes");
      return false;
    }
    if (expr->range.min < 0) {
      expr->range.max = std::max<std::int64_t>(expr->range.max, 0);
      return check_.unproved(expr->place,
                             fmt::format("the {} {} can be negative", what, quote(to_text(*expr))),
                             fmt::format("it is {} to {}; 'valid' can narrow what it is made of",
                                         expr->range.min, expr->range.max));
    }
    if (expr->range.max == 0) {
      check_.error_elsewhere(expr->place,
                             fmt::format("the {} {} is always 0", what, quote(to_text(*expr))),
                             "a field has bytes");
      return check_.at_run_time;
    }
    return true;
  }

  void check_last(const Field& field, std::size_t index) {
    if (last(index)) return;
    if (field.extent == ExtentKind::kToEnd || field.repeat == RepeatKind::kToEnd) {
      check_.error_elsewhere(
          field.place, fmt::format("field {} takes all bytes but is not the last", quote(field.id)),
          "nothing can follow it");
    }
  }

  /// Returns the size of one element, before size, repeat and condition.
  Size element(const Field& field) const {
    switch (field.kind) {
      case ValueKind::kBytes: return {0, kUnbounded};
      case ValueKind::kStruct: break;
      default: {
        const auto width = static_cast<std::uint32_t>(field.width_bytes) - field.shared_bytes();
        return {width, width};
      }
    }
    if (!field.choice) return {field.type->min_size, field.type->max_size};
    // Without `_` anything may stay opaque.
    if (!field.choice->otherwise) return {0, kUnbounded};
    std::uint32_t least = field.choice->otherwise->type->min_size;
    for (const SwitchCase& one : field.choice->cases) least = std::min(least, one.type->min_size);
    return {least, kUnbounded};
  }

  void measure(Field& field, std::size_t index, bool conditional) {
    Size size = element(field);
    const bool varies = size.min != size.max;
    if (field.kind == ValueKind::kStruct && varies && field.extent == ExtentKind::kOwn &&
        (field.repeat != RepeatKind::kOnce || !last(index))) {
      check_.error_elsewhere(field.place,
                             fmt::format("structure {} varies in size", quote(field.id)),
                             "only the last field can, or one with a size");
      is_open_ |= !check_.at_run_time;
    }
    if (field.extent == ExtentKind::kSize) size = sized(field, size);
    if (field.extent == ExtentKind::kToEnd) size.max = kUnbounded;
    if (field.extent == ExtentKind::kTerminated) {
      size = {field.text->may_lack_its_end ? 0U : 1U, kUnbounded};
    }
    if (field.repeat != RepeatKind::kOnce && size.max == 0) {
      check_.error(place_of(field.places, "repeat", field.place),
                   fmt::format("{} repeats what takes no byte", quote(field.id)),
                   "an element of a byte or more was expected");
      is_open_ = true;
    }
    if (field.repeat == RepeatKind::kCount) {
      const Interval count{std::max<std::int64_t>(field.count->range.min, 0),
                           field.count->range.max};
      size = {times(size.min, count.min), times(size.max, count.max)};
    }
    if (field.repeat == RepeatKind::kToEnd) size = {0, kUnbounded};
    if (field.repeat == RepeatKind::kUntil) size.max = kUnbounded;
    if (conditional) size.min = 0;
    field.min_size = size.min;
    field.max_size = size.max;
    type_.min_size = plus(type_.min_size, size.min);
    type_.max_size = plus(type_.max_size, size.max);
    const bool fixed = size.min == size.max && offset_ >= 0;
    offset_ = fixed ? offset_ + size.min : -1;
  }

  Size sized(const Field& field, Size inner) {
    const Interval range{std::max<std::int64_t>(field.size->range.min, 0), field.size->range.max};
    const Size out{std::max(bounded(static_cast<std::uint64_t>(range.min)), inner.min),
                   bounded(static_cast<std::uint64_t>(range.max))};
    if (field.kind == ValueKind::kStruct && inner.min > out.max) {
      check_.error(field.size->place,
                   fmt::format("{} never fits in {}", quote(field.id), bytes_text(out.max)),
                   fmt::format("it has at least {}", inner.min));
      is_open_ = true;
    }
    return out;
  }

  void check_declared() {
    if (!type_.declared_size) return;
    const std::int64_t declared = *type_.declared_size;
    const SourcePlace& place = place_of(type_.places, "-size", type_.place);
    if (type_.max_size != kUnbounded) {
      if (declared == type_.max_size) return;
      check_.error(
          place, fmt::format("-size {} does not add up", declared),
          fmt::format("the fields of {} take {}", quote(type_.id), bytes_text(type_.max_size)));
    } else if (declared <= type_.min_size || declared >= kUnbounded) {
      check_.error(place, fmt::format("-size {} leaves no room", declared),
                   fmt::format("{} has at least {} and takes what follows", quote(type_.id),
                               bytes_text(type_.min_size)));
    } else {
      type_.max_size = static_cast<std::uint32_t>(declared);
    }
  }

  Check& check_;
  Type& type_;
  std::int64_t offset_ = 0;
  int bits_ = 0;  // Of the fields of bits right before.
  bool is_open_ = false;
};

constexpr int kTypeNestingMax = 100;

enum class Mark { kNew, kOpen, kDone };

class Order {
 public:
  explicit Order(Check& check) : check_(check) {}

  void visit(Type& type, int depth) {
    marks_[&type] = Mark::kOpen;
    for (const auto* list : {&type.fields, &type.instances}) {
      for (const auto& field : *list) visit_field(*field, depth);
    }
    marks_[&type] = Mark::kDone;
    check_.order.push_back(&type);
  }

  Mark mark(const Type& type) { return marks_[&type]; }

 private:
  void visit_field(const Field& field, int depth) {
    if (field.type != nullptr) {
      visit_used(*field.type, field, place_of(field.places, "type", field.place), depth);
    }
    if (!field.choice) return;
    for (const SwitchCase& one : field.choice->cases) {
      if (one.type != nullptr) visit_used(*one.type, field, one.place, depth);
    }
    const auto& otherwise = field.choice->otherwise;
    if (otherwise && otherwise->type != nullptr) {
      visit_used(*otherwise->type, field, otherwise->place, depth);
    }
  }

  void visit_used(const Type& used, const Field& field, const SourcePlace& place, int depth) {
    if (marks_[&used] == Mark::kOpen) {
      check_.error(place, fmt::format("type {} contains itself", quote(used.id)),
                   "types must not form a circle");
      check_.open.insert(&field);
    } else if (depth > kTypeNestingMax) {
      check_.error(place, "types nest too deep", fmt::format("at most {} levels", kTypeNestingMax));
      check_.open.insert(&field);
    } else if (marks_[&used] == Mark::kNew) {
      visit(const_cast<Type&>(used), depth + 1);  // The model is ours to complete.
    }
  }

  Check& check_;
  std::map<const Type*, Mark> marks_;
};

}  // namespace

void check_layout(Check& check) {
  for (Type* type : check.order) {
    if (type->is_mask) {
      type->min_size = type->max_size = type->bits.size() > 8 ? 2 : 1;
      if (type->declared_size && *type->declared_size != type->max_size) {
        check.error(place_of(type->places, "-size", type->place),
                    fmt::format("-size {} does not add up", *type->declared_size),
                    "the mask takes " + bytes_text(type->max_size));
      }
      continue;
    }
    Layout(check, *type).run();
    check_instances(check, *type);
  }
}

void check_order(Check& check) {
  Order order(check);
  for (const auto& spec : check.model.specs) {
    for (const auto& type : spec->types) {
      if (order.mark(*type) == Mark::kNew) order.visit(*type, 0);
    }
  }
  for (const auto& spec : check.model.specs) {
    spec->dependency_order.clear();
    for (const Type* type : check.order) {
      if (type->spec == spec.get()) spec->dependency_order.push_back(type);
    }
  }
}

}  // namespace rubricc
