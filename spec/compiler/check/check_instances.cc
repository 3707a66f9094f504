// Peeks and interpretations of a type whose seq is laid out.
#include "spec/compiler/check/check.h"

namespace rubricc {
namespace {

constexpr std::int64_t kPositionMax = 0xFFFF;

bool check_position(Check& check, const Field& instance) {
  if (instance.position >= 0 && instance.position <= kPositionMax) return true;
  // -1 without `pos` was reported by the reader.
  if (instance.places.contains("pos")) {
    check.error(instance.places.at("pos"), fmt::format("pos {}", instance.position),
                fmt::format("0 to {} was expected", kPositionMax));
  }
  return false;
}

void check_peek(Check& check, const Type& type, Field& peek) {
  check_values(check, peek, {type, 0});
  peek.fixed_offset = peek.position;
  peek.min_size = peek.max_size = static_cast<std::uint32_t>(peek.width_bytes);
  if (peek.kind != ValueKind::kUint) {
    check.error_elsewhere(peek.place,
                          fmt::format("peek {} is not an unsigned number", quote(peek.id)),
                          "an instance is a number at pos, or a type over size-eos bytes at pos");
    check.open.insert(&peek);
  }
  if (peek.condition) {
    check.error(peek.condition->place, fmt::format("peek {} has a condition", quote(peek.id)),
                "conditions belong to interpretations");
  }
  const auto end = static_cast<std::uint64_t>(peek.position + peek.width_bytes);
  if (!check.at_run_time && !check.is_open(&type) && end > type.max_size) {
    check.error(peek.place,
                fmt::format("peek {} lies after the end of {}", quote(peek.id), quote(type.id)),
                fmt::format("{} has at most {}", quote(type.id), bytes_text(type.max_size)));
  }
}

void check_overlay(Check& check, const Type& type, Field& instance) {
  for (std::size_t i = 0; i < type.fields.size(); ++i) {
    const Field& field = *type.fields[i];
    const bool opaque = field.kind == ValueKind::kBytes && field.extent == ExtentKind::kToEnd;
    if (opaque && !check.is_open(&field) && field.fixed_offset == instance.position) {
      instance.overlays = static_cast<int>(i);
      return;
    }
  }
  if (check.is_open(&type)) return;
  check.error_elsewhere(
      instance.place, fmt::format("interpretation {} overlays nothing", quote(instance.id)),
      fmt::format("a size-eos field without type at offset {} was expected", instance.position));
}

void check_interpretation(Check& check, const Type& type, Field& instance) {
  if (instance.kind != ValueKind::kStruct || instance.extent != ExtentKind::kToEnd) {
    check.error_elsewhere(
        instance.place,
        fmt::format("instance {} is neither peek nor interpretation", quote(instance.id)),
        "a number at pos, or a type over size-eos bytes at pos was expected");
    return;
  }
  const Scope scope{type, type.fields.size(), true};
  instance.fixed_offset = instance.position;
  instance.max_size = kUnbounded;
  check_overlay(check, type, instance);
  if (instance.choice) check_switch(check, *instance.choice, instance, scope);
  if (!instance.condition) return;
  const ExprShape found = resolve_expr(check, *instance.condition, scope);
  if (found.shape != Shape::kBool && found.shape != Shape::kOpen) {
    check.error(instance.condition->place, "'if' is not a condition", "a comparison was expected");
  }
}

}  // namespace

void check_instances(Check& check, Type& type) {
  for (const auto& instance : type.instances) {
    if (!check_position(check, *instance)) {
      check.open.insert(instance.get());
    } else if (instance->is_peek) {
      check_peek(check, type, *instance);
    }
  }
  for (const auto& instance : type.instances) {
    if (instance->position >= 0 && !instance->is_peek) {
      check_interpretation(check, type, *instance);
    }
  }
}

}  // namespace rubricc
