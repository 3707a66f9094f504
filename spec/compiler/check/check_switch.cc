// Checks switches: possible keys, each once, and completeness.
#include <algorithm>
#include <map>

#include "spec/compiler/check/check.h"

namespace rubricc {
namespace {

const Field* set_of(const Switch& choice) {
  const Field* field = choice.key->op == ExprOp::kField ? choice.key->field : nullptr;
  return field != nullptr && field->valid && !field->valid->one_of.empty() ? field : nullptr;
}

/// Returns whether the key can be `value` at all.
bool is_possible(const Switch& choice, std::int64_t value) {
  if (const Field* field = set_of(choice)) {
    const auto& set = field->valid->one_of;
    return std::binary_search(set.begin(), set.end(), value);
  }
  return value >= choice.key->range.min && value <= choice.key->range.max;
}

std::string name_of(const Enum* enumeration, std::int64_t value) {
  if (enumeration != nullptr) {
    for (const EnumEntry& entry : enumeration->entries) {
      if (entry.value == value) return fmt::format("{}::{}", enumeration->id, entry.name);
    }
  }
  return std::to_string(value);
}

/// Requires a case for each key of a set given by `valid`, unless `_` takes the rest.
void check_complete(Check& check, const Switch& choice, const Enum* enumeration) {
  const Field* field = set_of(choice);
  if (field == nullptr || choice.otherwise) return;
  std::string missing;
  for (const std::int64_t value : field->valid->one_of) {
    const bool found = std::any_of(choice.cases.begin(), choice.cases.end(),
                                   [&](const SwitchCase& one) { return one.key == value; });
    if (found) continue;
    if (!missing.empty()) missing += ", ";
    missing += name_of(enumeration, value);
  }
  if (!missing.empty()) {
    check.error_elsewhere(choice.place, "missing cases: " + missing,
                          "'valid' allows them; '_' would take the rest");
  }
}

}  // namespace

void check_switch(Check& check, Switch& choice, const Field& field, const Scope& scope) {
  if (!choice.key) {
    check.open.insert(&field);
    return;
  }
  const ExprShape key = resolve_expr(check, *choice.key, scope);
  if (key.shape == Shape::kOpen) {
    check.open.insert(&field);
    return;
  }
  if (key.shape == Shape::kBool) {
    check.error(choice.key->place, "switch on a comparison", "a number or enum was expected");
    check.open.insert(&field);
    return;
  }
  std::map<std::int64_t, int> lines;
  bool complete = true;
  for (SwitchCase& one : choice.cases) {
    const auto value = resolve_constant(check, *one.key_expr, "switch-on", key.enumeration, scope);
    if (!value) {
      complete = false;
      continue;
    }
    one.key = *value;
    one.number = value;
    const auto [first, fresh] = lines.try_emplace(*value, one.place.line);
    if (!fresh) {
      check.error(one.place, fmt::format("duplicate case {}", name_of(key.enumeration, *value)),
                  fmt::format("line {} has it already", first->second));
    } else if (!is_possible(choice, *value)) {
      check.error_elsewhere(
          one.place, fmt::format("case {} can never be", name_of(key.enumeration, *value)),
          fmt::format("the switch takes {} to {}", choice.key->range.min, choice.key->range.max));
    }
  }
  std::stable_sort(choice.cases.begin(), choice.cases.end(),
                   [](const SwitchCase& a, const SwitchCase& b) { return a.key < b.key; });
  if (complete) check_complete(check, choice, key.enumeration);
}

}  // namespace rubricc
