#include "tools/format/json_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "codec/reflect/decode.h"
#include "codec/reflect/text_field.h"
#include "codec/text/text.h"
#include "tools/format/message_types.h"
#include "tools/format/put.h"

namespace rubric::format {
using reflect::Decoded;
using reflect::Field;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;

namespace {

char* put_key(char* at, const FieldPlan& plan) {
  return plan.key.size ? put(at, plan.key) : put(at, std::string_view(plan.long_key));
}

char* put_bits(char* at, const FieldPlan& plan, std::int64_t value) {
  at = plan.bits_open.size ? put(at, plan.bits_open)
                           : put(put(at, std::string_view(plan.bits_key)), "[");
  // Every element brings its comma; the bracket replaces the first one.
  char* const open = --at;
  for (auto bits = static_cast<std::uint32_t>(value); bits; bits &= bits - 1) {
    at = put(at, plan.bits[static_cast<std::size_t>(std::countr_zero(bits))]);
  }
  at += at == open;
  *open = '[';
  *at++ = ']';
  return at;
}

char* put_quoted_hex(char* at, Bytes bytes) {
  *at++ = '"';
  at = put_hex(at, bytes);
  *at++ = '"';
  return at;
}

char* put_raw(char* at, const Field& field, std::int64_t value) {
  if (field.kind == Kind::kFloat) return put_float(at, static_cast<std::uint32_t>(value));
  return put_integer(at, field, value);
}

}  // namespace

bool is_text(const Field* field) {
  return field && field->text && field->text->encoding != reflect::Encoding::kNone;
}

double converted(const Field& field, std::int64_t raw) {
  auto number = static_cast<double>(field.whole(raw));
  if (field.kind == Kind::kFloat) number = float_of_bits(static_cast<std::uint32_t>(raw));
  const double value = number * field.unit->scale + field.unit->offset;
  // 6340 * 0.01 - 40 is 23.4, not 23.400000000000006.
  constexpr double kSteps = 1e9;
  const double rounded = std::round(value * kSteps) / kSteps;
  return std::isfinite(rounded) && std::abs(rounded) < 1e6 ? rounded : value;
}

namespace {

struct Decimal {
  reflect::Whole digits;
  int exponent;  ///< Of the power of ten that they are multiplied by.

  /// Gives more digits after the point; returns whether they fit.
  bool scale_to(int less) {
    for (; exponent > less; --exponent) {
      if (__builtin_mul_overflow(digits, 10, &digits)) return false;
    }
    return true;
  }
};

/// Returns the shortest decimal that reads back as the same, as the spec has it.
Decimal decimal_of(double value) {
  char text[kMaxFloatChars] = {};
  std::to_chars(text, std::end(text) - 1, value, std::chars_format::scientific);
  Decimal out{0, 0};
  bool fraction = false;
  const char* at = text + (value < 0);
  for (; *at != 'e'; ++at) {
    if (*at == '.') {
      fraction = true;
    } else {
      out.digits = out.digits * 10 + (*at - '0');
      out.exponent -= fraction;
    }
  }
  if (value < 0) out.digits = -out.digits;
  out.exponent += std::atoi(at + 1);
  return out;
}

/// Returns the text, or an empty one where the digits or the characters are too many.
std::string decimal_text(const Field& field, std::int64_t raw) {
  Decimal sum = decimal_of(field.unit->scale);
  Decimal offset = decimal_of(field.unit->offset);
  if (__builtin_mul_overflow(sum.digits, field.whole(raw), &sum.digits)) return {};
  const int exponent = std::min({sum.exponent, offset.exponent, 0});
  if (!sum.scale_to(exponent) || !offset.scale_to(exponent)) return {};
  if (__builtin_add_overflow(sum.digits, offset.digits, &sum.digits)) return {};
  while (sum.exponent < 0 && sum.digits % 10 == 0) {
    sum.digits /= 10;
    ++sum.exponent;
  }
  const auto decimals = static_cast<std::size_t>(-sum.exponent);
  std::string out;  // From its end.
  for (reflect::Whole rest = sum.digits; rest != 0 || out.size() <= decimals; rest /= 10) {
    out += static_cast<char>('0' + std::abs(static_cast<int>(rest % 10)));
  }
  if (decimals != 0) out.insert(decimals, ".");
  if (sum.digits < 0) out += '-';
  std::reverse(out.begin(), out.end());
  return out.size() <= kMaxFloatChars ? out : std::string();
}

}  // namespace

char* put_converted(char* at, const Field& field, std::int64_t raw) {
  const std::string text = field.kind == Kind::kFloat ? std::string() : decimal_text(field, raw);
  return text.empty() ? put_double(at, converted(field, raw)) : put(at, std::string_view(text));
}

char* JsonNodes::value(char* at, const Decoded& decoded, std::size_t node) const {
  const Node& n = decoded[node];
  switch (n.kind) {
    case NodeKind::kStruct: return object(at, decoded, node);
    case NodeKind::kStructArray: return structs(at, decoded, node);
    case NodeKind::kNumberArray: return array(at, plan_.field(n.field), decoded, n);
    case NodeKind::kNumber: return put_raw(at, *n.field, n.value);
    case NodeKind::kBytes: break;
  }
  const Bytes bytes = decoded.bytes.sub(n.offset, n.size);
  if (is_text(n.field)) return text::put_json_string(at, reflect::shown_text(*n.field, bytes));
  return put_quoted_hex(at, bytes);
}

char* JsonNodes::object(char* at, const Decoded& decoded, std::size_t node) const {
  char* const open = at;
  at = members(at, decoded, node + 1, decoded[node].end);
  at += at == open;
  *open = '{';
  *at++ = '}';
  return at;
}

char* JsonNodes::members(char* at, const Decoded& decoded, std::size_t from,
                         std::size_t end) const {
  for (std::size_t i = from; i < end;) {
    const Node& node = decoded[i];
    const FieldPlan& plan = plan_.field(node.field);
    if (node.kind == NodeKind::kNumber) {
      at = number(at, plan, node.value);
      ++i;
      continue;
    }
    at = value(put_key(at, plan), decoded, i);
    if (node.kind == NodeKind::kBytes && is_text(node.field)) {
      const Bytes bytes = decoded.bytes.sub(node.offset, node.size);
      if (!reflect::says_all(*node.field, bytes)) {
        at = put_quoted_hex(put(at, std::string_view(plan.hex_key)), bytes);
      }
    }
    if (plan_.units() && node.kind == NodeKind::kNumberArray && !plan.unit_key.empty()) {
      at = put(at, std::string_view(plan.unit_key));
      char* const open = at;
      for (std::uint32_t k = 0; k < node.count; ++k) {
        *at++ = ',';
        const std::uint8_t* raw = decoded.bytes.data() + node.offset + k * plan.field->width_bytes;
        at = put_converted(at, *plan.field, reflect::load_number(*plan.field, raw));
      }
      at += at == open;
      *open = '[';
      *at++ = ']';
    }
    i = node.end;
  }
  return at;
}

char* JsonNodes::number(char* at, const FieldPlan& plan, std::int64_t value) const {
  if (plan.plain) return put_int(put(at, plan.key), value);
  // An enum with all names: number and name are one ready-made piece.
  const std::uint64_t slot =
      static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(plan.first_value);
  if (slot < plan.members.size() && plan.members[slot].size) return put(at, plan.members[slot]);
  if (plan.enumerated) return put(put_int(put(at, plan.key), value), plan.nameless);
  return number_beside(at, plan, value);
}

char* JsonNodes::number_beside(char* at, const FieldPlan& plan, std::int64_t value) const {
  const Field& field = *plan.field;
  at = put_raw(put_key(at, plan), field, value);
  if (field.enumeration) {
    const char* name = reflect::enum_name(*field.enumeration, value);
    at = put(at, std::string_view(plan.name_key));
    at = name ? put(put(put(at, "\""), std::string_view(name)), "\"") : put(at, "null");
  }
  if (field.mask) at = put_bits(at, plan, value);
  if (!plan.unit_key.empty()) {
    at = put_converted(put(at, std::string_view(plan.unit_key)), field, value);
  }
  return at;
}

char* JsonNodes::array(char* at, const FieldPlan& plan, const Decoded& decoded,
                       const Node& node) const {
  const Field& field = *plan.field;
  const std::uint8_t* raw = decoded.bytes.data() + node.offset;
  char* const open = at;
  for (std::uint32_t i = 0; i < node.count; ++i, raw += field.width_bytes) {
    *at++ = ',';
    at = put_raw(at, field, reflect::load_number(field, raw));
  }
  at += at == open;
  *open = '[';
  *at++ = ']';
  return at;
}

char* JsonNodes::structs(char* at, const Decoded& decoded, std::size_t node) const {
  char* const open = at;
  for (std::size_t i = node + 1; i < decoded[node].end; i = decoded[i].end) {
    *at++ = ',';
    at = object(at, decoded, i);
  }
  at += at == open;
  *open = '[';
  *at++ = ']';
  return at;
}

using reflect::Field;
using reflect::Kind;
using reflect::Type;

namespace {

constexpr std::int64_t kMaxEnumSpan = 512;

void plan_enum(const reflect::EnumTable& table, FieldPlan& plan) {
  if (table.count == 0) return;
  plan.first_value = table.entries[0].value;
  const std::int64_t span = table.entries[table.count - 1].value - plan.first_value + 1;
  if (span > kMaxEnumSpan) return;
  plan.enumerated = plan.key.size > 0 && plan.nameless.set(plan.name_key + "null");
  plan.members.resize(static_cast<std::size_t>(span));
  for (int i = 0; i < table.count; ++i) {
    const reflect::EnumEntry& entry = table.entries[i];
    const auto at = static_cast<std::size_t>(entry.value - plan.first_value);
    const bool fits = plan.members[at].set(
        fmt::format("{}{}{}\"{}\"", plan.long_key, entry.value, plan.name_key, entry.name));
    plan.enumerated = plan.enumerated && fits;
  }
}

// Returns the most characters that all names together take.
std::size_t plan_mask(const reflect::MaskTable& table, FieldPlan& plan) {
  std::size_t chars = 0;
  plan.bits_open.set(plan.bits_key + "[");
  plan.bits.resize(table.width_bits);
  for (std::size_t bit = 0; bit < plan.bits.size(); ++bit) {
    const char* name = table.bit_names[bit];
    const std::string text = name ? fmt::format(",\"{}\"", name) : fmt::format(",\"bit{}\"", bit);
    // A name that does not fit is cut in place of the spec compiler, not here.
    if (!plan.bits[bit].set(text)) plan.bits[bit].set(fmt::format(",\"bit{}\"", bit));
    chars += text.size();
  }
  return chars;
}

std::size_t longest_name(const reflect::EnumTable& table) {
  std::size_t longest = 0;
  for (int i = 0; i < table.count; ++i) {
    longest = std::max(longest, std::strlen(table.entries[i].name));
  }
  return longest;
}

}  // namespace

bool Piece::set(std::string_view value) {
  if (value.size() > sizeof(text)) return false;
  std::memcpy(text, value.data(), value.size());
  size = static_cast<std::uint8_t>(value.size());
  return true;
}

JsonPlan::JsonPlan(const reflect::Protocol& protocol, bool units) : units_(units) {
  for (const Type* type : all_types(protocol)) {
    for (int i = 0; i < type->field_count; ++i) add(type->fields[i]);
    for (int i = 0; i < type->interpretation_count; ++i) add(type->interpretations[i].field);
  }
  index_addresses();
}

void JsonPlan::add(const Field& field) {
  FieldPlan& plan = plans_.emplace_back();
  plan.field = &field;
  plan.long_key = fmt::format(",{}", std::string_view(field.json_key, field.json_key_size));
  plan.key.set(plan.long_key);
  plan.name_key = fmt::format(",\"{}_name\":", field.name);
  plan.bits_key = fmt::format(",\"{}_bits\":", field.name);
  std::size_t chars = plan.long_key.size() + kMaxFloatChars + 2;
  if (field.text) {
    plan.hex_key = fmt::format(",\"{}_hex\":", field.name);
    chars += plan.hex_key.size() + 4;
  }
  const bool unit = units_ && field.unit && field.kind != Kind::kFloat;
  if (unit) {
    plan.unit_key = fmt::format(",\"{}_{}\":", field.name, field.unit->symbol);
    chars += plan.unit_key.size() + kMaxFloatChars;
  }
  if (field.enumeration) {
    chars += plan.name_key.size() + longest_name(*field.enumeration) + 2;
    if (!unit && !field.is_wide()) plan_enum(*field.enumeration, plan);
  }
  if (field.mask) chars += plan.bits_key.size() + plan_mask(*field.mask, plan) + 2;
  plan.plain = !unit && !field.enumeration && !field.mask && field.kind != Kind::kFloat &&
               !field.is_wide() && plan.key.size > 0;
  max_member_chars_ = std::max(max_member_chars_, chars + 2 * kPieceRoom);
}

void JsonPlan::index_addresses() {
  const auto address = [](const FieldPlan& plan) {
    return reinterpret_cast<std::uintptr_t>(plan.field);
  };
  if (plans_.empty()) return;
  std::uintptr_t last = 0;
  first_address_ = address(plans_[0]);
  for (const FieldPlan& plan : plans_) {
    first_address_ = std::min(first_address_, address(plan));
    last = std::max(last, address(plan));
  }
  // The tables of a protocol lie side by side, so the distances are small; those of two that are
  // read as one may lie anywhere.
  constexpr std::uintptr_t kSlotsMax = 1U << 16;
  const std::uintptr_t slots = (last - first_address_) / kStep + 1;
  if (slots > kSlotsMax) {
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      far_[plans_[i].field] = static_cast<std::uint16_t>(i);
    }
    return;
  }
  slots_.resize(slots);
  for (std::size_t i = 0; i < plans_.size(); ++i) {
    slots_[(address(plans_[i]) - first_address_) / kStep] = static_cast<std::uint16_t>(i);
  }
}

}  // namespace rubric::format
