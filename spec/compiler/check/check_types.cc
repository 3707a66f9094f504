// Requirements, carriers and AM types; switches: possible keys, each once, and completeness.

#include <algorithm>
#include <array>
#include <map>

#include "spec/compiler/check/check.h"

namespace rubricc {
namespace {

constexpr std::array<std::string_view, 6> kCarriers{"serial",    "radio_i",      "radio_t",
                                                    "radio_ack", "radio_beacon", "radio_command"};

class Requirements {
 public:
  explicit Requirements(Check& check) : check_(check) {
    for (const Requirement& one : check.model.requirements) ids_.push_back(one.id);
    std::sort(ids_.begin(), ids_.end());
  }

  void check_type(Type& type) {
    known(type.requirement, place_of(type.places, "-requirement", type.place));
    const bool needed =
        !check_.at_run_time && !type.is_mask && type.carrier.empty() && type.id != type.spec->id;
    if (needed && !type.places.contains("-requirement") && !type.refused_keys) {
      check_.error(type.place, fmt::format("type {} without requirement", quote(type.id)),
                   "-requirement: was expected");
    }
    for (const auto* list : {&type.fields, &type.instances}) {
      for (const auto& field : *list) inherit(type, *field);
    }
  }

 private:
  /// Drops the name of an unknown rule where it is no error: its number may be another rule's.
  void known(std::string& id, const SourcePlace& place) {
    if (id.empty()) return;
    if (ids_.empty() || std::binary_search(ids_.begin(), ids_.end(), id)) return;
    if (check_.at_run_time) return id.clear();
    check_.error(place, fmt::format("unknown requirement {}", quote(id)), suggestion(id, ids_));
  }

  /// Inherits a requirement: the field's own, else that of its type, else that of the type it
  /// holds.
  void inherit(const Type& type, Field& field) {
    known(field.requirement, place_of(field.places, "-requirement", field.place));
    if (field.requirement.empty()) field.requirement = type.requirement;
    if (field.requirement.empty() && field.type != nullptr) {
      field.requirement = field.type->requirement;
    }
  }

  Check& check_;
  std::vector<std::string> ids_;
};

/// A carrier's switch chooses by AM type; what it chooses must not claim another.
void check_am_types(Check& check, const Type& carrier) {
  for (const auto& field : carrier.fields) {
    if (!field->choice) continue;
    for (const SwitchCase& one : field->choice->cases) {
      if (!one.number || one.type == nullptr || one.type->am_types.empty()) continue;
      const auto& own = one.type->am_types;
      if (std::find(own.begin(), own.end(), *one.number) != own.end()) continue;
      check.error(one.place,
                  fmt::format("case {} leads to {}, whose AM type is {}", *one.number,
                              quote(one.type_name), own.front()),
                  "the switch of a carrier and -am-type must agree");
    }
  }
}

/// Frames on the radio are taken apart before their fields are read: the AM type, a number, is at a
/// constant place, and chooses the structure of the rest.
void check_radio(Check& check, const Type& carrier) {
  const Field& last = *carrier.fields.back();
  const bool chosen = last.choice && last.choice->key && last.choice->key->op == ExprOp::kField;
  if (chosen && last.fixed_offset >= 0 && last.extent == ExtentKind::kToEnd &&
      last.choice->key->field && last.choice->key->field->width_bytes == 1) {
    return;
  }
  check.error(place_of(carrier.places, "-carrier", carrier.place),
              fmt::format("carrier {} does not end in a message", carrier.carrier),
              "at the end size-eos: true with a switch on a u1 field was expected");
}

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

void check_types(Check& check) {
  Requirements requirements(check);
  for (const auto& spec : check.model.specs) {
    std::map<std::string, int> lines;
    for (const auto& type : spec->types) {
      requirements.check_type(*type);
      if (type->carrier.empty()) continue;
      check_am_types(check, *type);
      const bool radio = type->carrier == "radio_i" || type->carrier == "radio_t";
      if (radio && !type->fields.empty() && !check.is_open(type.get())) check_radio(check, *type);
      const SourcePlace& place = place_of(type->places, "-carrier", type->place);
      if (std::find(kCarriers.begin(), kCarriers.end(), type->carrier) == kCarriers.end()) {
        check.error(place, fmt::format("unknown carrier {}", quote(type->carrier)),
                    suggestion(type->carrier, kCarriers));
      }
      const auto [first, fresh] = lines.try_emplace(type->carrier, place.line);
      if (!fresh) {
        check.error(place, fmt::format("duplicate carrier {}", quote(type->carrier)),
                    fmt::format("line {} has it already", first->second));
      }
    }
  }
}

namespace {

void resolve_call(Check& check, const Type* type, std::vector<ExprPtr>& arguments,
                  const SourcePlace& place, const Scope& scope) {
  if (type == nullptr) return;
  if (arguments.size() != type->params.size()) {
    check.error(place, fmt::format("arguments for type {}: {}", quote(type->id), arguments.size()),
                fmt::format("as many as its parameters were expected: {}", type->params.size()));
    return;
  }
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const Param& param = type->params[i];
    Expr& expr = *arguments[i];
    const ExprShape found = resolve_expr(check, expr, scope);
    if (found.shape == Shape::kOpen) continue;
    const Shape wanted = param.is_bool                  ? Shape::kBool
                         : param.enumeration != nullptr ? Shape::kEnum
                                                        : Shape::kInt;
    if (found.shape != wanted ||
        (wanted == Shape::kEnum && found.enumeration != param.enumeration)) {
      check.error(expr.place,
                  fmt::format("{} does not fit {}", quote(to_text(expr)), quote(param.id)),
                  "an argument of the parameter's type was expected");
    } else if (expr.range.max < param.range.min || expr.range.min > param.range.max) {
      check.error(expr.place,
                  fmt::format("{} never fits {}", quote(to_text(expr)), quote(param.id)),
                  fmt::format("{} to {} was expected", param.range.min, param.range.max));
    } else if (expr.range.min < param.range.min || expr.range.max > param.range.max) {
      check.unproved(expr.place,
                     fmt::format("{} can be beyond {}", quote(to_text(expr)), quote(param.id)),
                     fmt::format("{} to {} was expected", param.range.min, param.range.max));
    }
  }
}

}  // namespace

void resolve_calls(Check& check, Field& field, const Scope& scope) {
  resolve_call(check, field.type, field.arguments, place_of(field.places, "type", field.place),
               scope);
  if (!field.choice) return;
  for (SwitchCase& one : field.choice->cases) {
    resolve_call(check, one.type, one.arguments, one.place, scope);
  }
  if (!field.choice->otherwise) return;
  SwitchCase& rest = *field.choice->otherwise;
  resolve_call(check, rest.type, rest.arguments, rest.place, scope);
}

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
