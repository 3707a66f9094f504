// Checks which keys fit which kind of field.
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

/// Text and bits are read at run time alone.
void check_plain(Check& check, const Field& field) {
  if (check.at_run_time) return;
  const Place& place = place_of(field.places, "type", field.place);
  if (field.text) {
    check.error(place, fmt::format("text or a terminator in {}", quote(field.id)),
                "bytes were expected; rubric --spec reads text");
  }
  if (field.bit_width > 0) {
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
  const Place& place = place_of(field.places, "repeat", field.place);
  if (field.kind == ValueKind::kBytes || field.extent != ExtentKind::kOwn) {
    check.error(place, "repeat of bytes", "numbers, masks or structures can repeat");
    check.open.insert(&field);
  }
  if (field.repeat == RepeatKind::kCount && !field.count) check.open.insert(&field);
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

}  // namespace rubricc
