#include "tools/explain/reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "tools/explain/type_text.h"

namespace rubric::explain {

using reflect::Field;
using reflect::Protocol;
using reflect::Type;

namespace {

// Both radio framings lead to the same messages.
std::string carrier_of(const Protocol& protocol, const Type& type) {
  for (int i = 0; i < protocol.carrier_count; ++i) {
    if (protocol.carriers[i].type != &type) continue;
    const std::string_view name = protocol.carriers[i].name;
    return std::string(name.starts_with("radio") ? "radio" : name);
  }
  return {};
}

bool leads_to(const Field& f, const Type& message, Reach& reach) {
  if (f.kind != reflect::Kind::kStruct) return false;
  if (!f.choice) return f.type == &message;
  for (int i = 0; i < f.choice->count; ++i) {
    if (f.choice->cases[i].type == &message) reach.values.push_back(f.choice->cases[i].key);
  }
  reach.otherwise = f.choice->otherwise == &message;
  if (reach.values.empty() && !reach.otherwise) return false;
  reach.key = expr_text(f.choice->key, *reach.parent);
  if (f.choice->key.count == 1) {
    path_at(*reach.parent, f.choice->key.steps[0].value, &reach.key_field);
  }
  return true;
}

bool same_carrier_way(const Reach& a, const Reach& b) {
  return !a.carrier.empty() && a.carrier == b.carrier && a.values == b.values;
}

void add(const Protocol& protocol, const Type& parent, const Field& f, const Type& message,
         std::vector<Reach>& found) {
  Reach reach;
  reach.parent = &parent;
  reach.field = &f;
  if (!leads_to(f, message, reach)) return;
  reach.condition = expr_text(f.condition, parent);
  if (!reach.key.empty()) reach.carrier = carrier_of(protocol, parent);
  for (const Reach& known : found) {
    if (same_carrier_way(known, reach)) return;
  }
  found.push_back(std::move(reach));
}

}  // namespace

std::vector<Reach> reaches(const Protocol& protocol, const Type& message) {
  std::vector<Reach> found;
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& parent = *protocol.types[i];
    for (int k = 0; k < parent.field_count; ++k) {
      add(protocol, parent, parent.fields[k], message, found);
    }
    for (int k = 0; k < parent.interpretation_count; ++k) {
      add(protocol, parent, parent.interpretations[k].field, message, found);
    }
  }
  std::stable_partition(found.begin(), found.end(),
                        [](const Reach& reach) { return !reach.carrier.empty(); });
  return found;
}

namespace {

std::string text_in(const Reach& reach, const char* parent) {
  std::string values;
  const reflect::EnumTable* names = reach.key_field ? reach.key_field->enumeration : nullptr;
  for (std::size_t i = 0; i < reach.values.size(); ++i) {
    values += (i ? ", " : "") + (reach.carrier.empty() ? key_text(reach.values[i], names)
                                                       : std::to_string(reach.values[i]));
  }
  if (!reach.carrier.empty()) return fmt::format("AM {} on {}", values, reach.carrier);
  std::string text = fmt::format("{} of {}", reach.field->name, parent);
  if (!reach.condition.empty()) text += " if " + reach.condition;
  if (reach.key.empty()) return text;
  if (reach.otherwise) values += values.empty() ? "any other" : " or any other";
  return text +
         fmt::format("{} {} is {}", reach.condition.empty() ? " if" : " and", reach.key, values);
}

}  // namespace

std::string reach_text(const Reach& reach) { return text_in(reach, reach.parent->id); }

std::vector<std::string> reach_texts(const std::vector<Reach>& reaches) {
  std::vector<std::string> texts;
  for (const Reach& reach : reaches) {
    const std::string shared = text_in(reach, reach.parent->name);
    const auto alike = std::count_if(reaches.begin(), reaches.end(), [&](const Reach& other) {
      return text_in(other, other.parent->name) == shared;
    });
    const std::string text = alike > 1 ? shared : reach_text(reach);
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  return texts;
}

std::vector<std::int64_t> am_types(const std::vector<Reach>& reaches) {
  std::vector<std::int64_t> types;
  for (const Reach& reach : reaches) {
    if (!reach.carrier.empty()) types.insert(types.end(), reach.values.begin(), reach.values.end());
  }
  std::sort(types.begin(), types.end());
  types.erase(std::unique(types.begin(), types.end()), types.end());
  return types;
}

bool is_carrier(const Protocol& protocol, const Type& type) {
  return !carrier_of(protocol, type).empty();
}

bool is_part(const std::vector<Reach>& reaches) {
  return !reaches.empty() && std::all_of(reaches.begin(), reaches.end(), [](const Reach& reach) {
    return reach.key.empty() && reach.condition.empty();
  });
}

}  // namespace rubric::explain
