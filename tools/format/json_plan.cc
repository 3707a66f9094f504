#include "tools/format/json_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/reflect/decode.h"
#include "tools/format/message_types.h"
#include "tools/format/put.h"

namespace rubric::format {

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
  const bool unit = units_ && field.unit && field.kind != Kind::kFloat;
  if (unit) {
    plan.unit_key = fmt::format(",\"{}_{}\":", field.name, field.unit->symbol);
    chars += plan.unit_key.size() + kMaxFloatChars;
  }
  if (field.enumeration) {
    chars += plan.name_key.size() + longest_name(*field.enumeration) + 2;
    if (!unit) plan_enum(*field.enumeration, plan);
  }
  if (field.mask) chars += plan.bits_key.size() + plan_mask(*field.mask, plan) + 2;
  plan.plain =
      !unit && !field.enumeration && !field.mask && field.kind != Kind::kFloat && plan.key.size > 0;
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
  // The tables of a protocol are one object file's constants, so the distances are small.
  slots_.resize((last - first_address_) / kStep + 1);
  for (std::size_t i = 0; i < plans_.size(); ++i) {
    slots_[(address(plans_[i]) - first_address_) / kStep] = static_cast<std::uint16_t>(i);
  }
}

}  // namespace rubric::format
