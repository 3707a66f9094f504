// Looks things up in the tables, by name or by value.
#include <algorithm>

#include "codec/reflect/decode.h"

namespace rubric::reflect {

const Type* find_type(const Protocol& protocol, std::string_view name) {
  for (int i = 0; i < protocol.type_count; ++i) {
    if (name == protocol.types[i]->id) return protocol.types[i];
  }
  for (int i = 0; i < protocol.type_count; ++i) {
    if (name == protocol.types[i]->name) return protocol.types[i];
  }
  return nullptr;
}

const Type* find_carrier(const Protocol& protocol, std::string_view carrier) {
  for (int i = 0; i < protocol.carrier_count; ++i) {
    if (carrier == protocol.carriers[i].name) return protocol.carriers[i].type;
  }
  return nullptr;
}

const char* enum_name(const EnumTable& table, std::int64_t value) {
  const EnumEntry* end = table.entries + table.count;
  // Most enums count up from their first value without gaps.
  const std::int64_t guess = table.count ? value - table.entries[0].value : -1;
  if (guess >= 0 && guess < table.count && table.entries[guess].value == value) {
    return table.entries[guess].name;
  }
  const EnumEntry* found = std::lower_bound(
      table.entries, end, value,
      [](const EnumEntry& e, std::int64_t v) { return static_cast<std::int64_t>(e.value) < v; });
  return found != end && static_cast<std::int64_t>(found->value) == value ? found->name : nullptr;
}

}  // namespace rubric::reflect
