// Checks which keys fit which kind of field; peeks and interpretations of a type whose seq is laid
// out.

#include "spec/compiler/check/check.h"

namespace rubricc {
namespace {

bool is_integer(const Field& field) {
  return field.kind == ValueKind::kUint || field.kind == ValueKind::kSint;
}
bool is_number(const Field& field) { return is_integer(field) || field.kind == ValueKind::kFloat; }

void check_bytes(Check& check, Field& field) {
  if (field.kind != ValueKind::kBytes || field.extent != ExtentKind::kOwn) return;
  check.open.insert(&field);
  if (field.refused_keys || field.places.contains("contents")) return;
  check.error(field.place, fmt::format("field {} has neither type nor size", quote(field.id)),
              "type, size, size-eos or contents was expected");
}

/// Refuses for code what tables in memory and dissectors alone read.
void check_plain(Check& check, const Field& field) {
  if (check.at_run_time) return;
  const SourcePlace& place = place_of(field.places, "type", field.place);
  if (field.text) {
    check.error(place, fmt::format("text or a terminator in {}", quote(field.id)),
                "bytes were expected; rubric --spec reads text");
  }
  if (field.repeat == RepeatKind::kUntil) {
    check.error(place_of(field.places, "repeat", field.place), "repeat: until",
                "a count was expected, so that the size is known before; rubric --spec reads it");
  }
  if (field.width_bytes == 8) {
    check.error(place, fmt::format("a number of 8 bytes in {}", quote(field.id)),
                "1, 2 or 4 bytes were expected; rubric --spec reads 8");
  }
  if (field.bit_width > 0 && field.places.contains("contents")) {
    check.error(field.places.at("contents"), "contents of 3 bytes",
                "1, 2 or 4 bytes were expected; rubric --spec reads 3");
  } else if (field.bit_width > 0) {
    check.error(place, "bits outside a mask",
                "-mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits");
  }
}

void check_bits(Check& check, const Field& field) {
  if (field.bit_width == 0) return;
  if (field.repeat != RepeatKind::kOnce || field.condition) {
    check.error(field.place, fmt::format("the bits {} repeat or may be absent", quote(field.id)),
                "bits that are always there, once, were expected");
  }
}

void check_extent(Check& check, Field& field) {
  const bool sized = field.extent != ExtentKind::kOwn;
  const char* key = field.extent == ExtentKind::kSize ? "size" : "size-eos";
  if (sized && (is_number(field) || field.kind == ValueKind::kMask)) {
    check.error(place_of(field.places, key, field.place), fmt::format("a {} for a number", key),
                "its type says how large it is");
    check.open.insert(&field);
  }
  if (field.choice && !sized) {
    check.error_elsewhere(field.choice->place,
                          fmt::format("the switch of {} has no size", quote(field.id)),
                          "size or size-eos bounds the bytes of an unknown case");
    if (!check.at_run_time) check.open.insert(&field);
  }
}

void check_repeat(Check& check, Field& field) {
  if (field.repeat == RepeatKind::kOnce) return;
  const SourcePlace& place = place_of(field.places, "repeat", field.place);
  const bool is_byte = field.kind == ValueKind::kBytes && !field.text && field.size &&
                       field.size->op == ExprOp::kInt && field.size->value == 1;
  if (is_byte && check.at_run_time) {  // Bytes one by one are shown as numbers.
    field.kind = ValueKind::kUint;
    field.width_bytes = 1;
    field.extent = ExtentKind::kOwn;
    field.size.reset();
  }
  if (field.kind == ValueKind::kBytes || field.extent != ExtentKind::kOwn) {
    check.error(place, "repeat of bytes",
                "numbers, masks or structures can repeat: put it into a type of its own");
    check.open.insert(&field);
  }
  if (field.repeat == RepeatKind::kCount && !field.count) check.open.insert(&field);
  if (field.repeat == RepeatKind::kUntil && !field.until) check.open.insert(&field);
}

void check_enum_use(Check& check, Field& field) {
  if (field.enum_name.empty() || field.kind == ValueKind::kUint) return;
  check.error(place_of(field.places, "enum", field.place),
              fmt::format("an enum on {}", quote(field.id)), "an unsigned number was expected");
  field.enumeration = nullptr;
}

void check_number_keys(Check& check, Field& field) {
  if (field.valid && !is_integer(field)) {
    check.error(field.valid->place, fmt::format("valid on {}", quote(field.id)),
                "an integer was expected");
    field.valid.reset();
  }
  if (field.expect_expr && (field.kind != ValueKind::kUint || field.repeat != RepeatKind::kOnce)) {
    check.error(field.expect_expr->place, fmt::format("-expect on {}", quote(field.id)),
                "a single unsigned number was expected");
    field.expect_expr.reset();
  }
  if (field.unit && (!is_number(field) || field.enumeration != nullptr)) {
    check.error(place_of(field.places, "-unit", field.place),
                fmt::format("-unit on {}", quote(field.id)), "a plain number was expected");
  }
}

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
  resolve_calls(check, instance, scope);
  if (!instance.condition) return;
  const ExprShape found = resolve_expr(check, *instance.condition, scope);
  if (found.shape != Shape::kBool && found.shape != Shape::kOpen) {
    check.error(instance.condition->place, "'if' is not a condition", "a comparison was expected");
  }
}

}  // namespace

void check_field_shape(Check& check, Field& field) {
  check_plain(check, field);
  check_bits(check, field);
  check_bytes(check, field);
  check_extent(check, field);
  check_repeat(check, field);
  check_enum_use(check, field);
  check_number_keys(check, field);
}

void check_instances(Check& check, Type& type) {
  for (const auto& instance : type.instances) {
    if (!check_position(check, *instance)) {
      check.open.insert(instance.get());
    } else if (instance->is_peek) {
      check_peek(check, type, *instance);
    }
  }
  for (const auto& instance : type.instances) {
    if (instance->position >= 0 && !instance->is_peek) check_interpretation(check, type, *instance);
  }
}

}  // namespace rubricc
