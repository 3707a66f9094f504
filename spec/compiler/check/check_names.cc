// Resolves names, and checks that no two are the same.
#include <algorithm>
#include <array>
#include <map>

#include "spec/compiler/check/check.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc {
namespace {

constexpr std::array<std::string_view, 16> kNumberTypes{
    "u1",   "u2",   "u4",   "s1",   "s2",   "s4",   "f4",   "u2be",
    "u2le", "u4be", "u4le", "s2be", "s2le", "s4be", "s4le", "f4le"};

/// DistinctNames that must differ, even in Pascal case.
class DistinctNames {
 public:
  DistinctNames(Check& check, std::string what) : check_(check), what_(std::move(what)) {}

  void add(const std::string& name, const SourcePlace& place) {
    const auto [found, fresh] = seen_.try_emplace(pascal(name), std::pair(name, place.line));
    if (fresh) return;
    const auto& [other, line] = found->second;
    if (other == name) {
      check_.error(place, fmt::format("duplicate {} {}", what_, quote(name)),
                   fmt::format("it is already in line {}", line));
    } else {
      check_.error(
          place, fmt::format("{}s {} and {} differ only in '_'", what_, quote(other), quote(name)),
          "they become one name in C++");
    }
  }

 private:
  Check& check_;
  std::string what_;
  std::map<std::string, std::pair<std::string, int>> seen_;
};

const Spec* import_named(const Spec& spec, std::string_view id) {
  for (const Spec* import : spec.imports) {
    if (import->id == id) return import;
  }
  return nullptr;
}

const Type* find_type(const Spec& spec, std::string_view id) {
  for (const auto& type : spec.types) {
    if (type->id == id) return type.get();
  }
  return nullptr;
}

/// The spec in which "spec::name" or "name" is looked up (null after an error), and the bare name.
struct Lookup {
  const Spec* spec;
  std::string name;
};
Lookup split(Check& check, const Spec& spec, const std::string& name, const SourcePlace& place) {
  const std::size_t colons = name.find("::");
  if (colons == name.npos) return {&spec, name};
  const std::string id = name.substr(0, colons);
  const Spec* import = import_named(spec, id);
  if (import == nullptr && find_type(spec, id) != nullptr) {  // A type within a type.
    return split(check, spec, name.substr(colons + 2), place);
  }
  if (import == nullptr) {
    // An import that could not be read was reported already.
    const bool failed = spec.imports.size() != spec.import_names.size();
    if (!failed) {
      check.error(place, fmt::format("{} is not imported", quote(id)),
                  suggestion(id, ids_of(spec.imports)));
    }
  }
  return {import, name.substr(colons + 2)};
}

const Type* find_type(Check& check, const Spec& spec, const std::string& name,
                      const SourcePlace& place) {
  const auto [where, id] = split(check, spec, name, place);
  if (where == nullptr) return nullptr;
  if (const Type* type = find_type(*where, id)) return type;
  const Spec* import = check.at_run_time ? import_named(spec, id) : nullptr;
  if (const Type* whole = import == nullptr ? nullptr : find_type(*import, id)) return whole;
  std::vector<std::string> known = ids_of(where->types);
  if (where == &spec) known.insert(known.end(), kNumberTypes.begin(), kNumberTypes.end());
  check.error(
      place, fmt::format("unknown type {}", quote(name)),
      id.starts_with("f8") ? "a float has 4 bytes; 'size: 8' keeps them" : suggestion(id, known));
  return nullptr;
}

void resolve_case(Check& check, const Spec& spec, const Field& field, SwitchCase& found) {
  found.type = find_type(check, spec, found.type_name, found.place);
  if (found.type == nullptr) {
    check.open.insert(&field);
  } else if (found.type->is_mask) {
    check.error(found.place, fmt::format("{} is a mask", quote(found.type_name)),
                "a case chooses a structure");
    check.open.insert(&field);
  }
}

void resolve_field(Check& check, const Spec& spec, Field& field) {
  if (field.kind == ValueKind::kStruct && !field.choice) {
    field.type =
        find_type(check, spec, field.type_name, place_of(field.places, "type", field.place));
    if (field.type == nullptr) {
      check.open.insert(&field);
    } else if (field.type->is_mask) {
      field.kind = ValueKind::kMask;
      field.width_bytes = field.type->bits.size() > 8 ? 2 : 1;
    }
  }
  if (field.choice) {
    for (SwitchCase& one : field.choice->cases) resolve_case(check, spec, field, one);
    if (field.choice->otherwise) resolve_case(check, spec, field, *field.choice->otherwise);
  }
  if (!field.enum_name.empty()) {
    const SourcePlace& place = place_of(field.places, "enum", field.place);
    const auto [where, id] = split(check, spec, field.enum_name, place);
    if (where == nullptr) return;
    field.enumeration = find_enum(*where, id);
    if (field.enumeration != nullptr) return;
    check.error(place, fmt::format("unknown enum {}", quote(field.enum_name)),
                suggestion(id, ids_of(where->enums)));
  }
}

void resolve_param(Check& check, const Spec& spec, Param& param) {
  if (param.enum_name.empty()) return;
  const auto [where, id] = split(check, spec, param.enum_name, param.place);
  if (where == nullptr) return;
  param.enumeration = find_enum(*where, id);
  if (param.enumeration != nullptr) return;
  check.error(param.place, fmt::format("unknown enum {}", quote(param.enum_name)),
              suggestion(id, ids_of(where->enums)));
}

void check_enum(Check& check, Enum& one) {
  DistinctNames names(check, "enum value");
  std::map<std::int64_t, int> lines;
  for (const EnumEntry& entry : one.entries) {
    names.add(entry.name, entry.place);
    const auto [first, fresh] = lines.try_emplace(entry.value, entry.place.line);
    if (!fresh) {
      check.error(entry.place, fmt::format("duplicate enum value {}", entry.value),
                  fmt::format("line {} names it already", first->second));
    }
  }
  if (one.entries.empty()) check.error(one.place, "an enum without values");
  std::stable_sort(one.entries.begin(), one.entries.end(),
                   [](const EnumEntry& a, const EnumEntry& b) { return a.value < b.value; });
}

void check_type_names(Check& check, const Type& type) {
  DistinctNames fields(check, "field");
  for (const Param& param : type.params) fields.add(param.id, param.place);
  for (const auto& field : type.fields) fields.add(field->id, field->place);
  for (const auto& field : type.instances) fields.add(field->id, field->place);
  DistinctNames bits(check, "bit");
  for (const MaskBit& bit : type.bits) bits.add(bit.name, type.place);
}

}  // namespace

const Enum* find_enum(const Spec& spec, const std::string& name) {
  for (const auto& one : spec.enums) {
    if (one->id == name) return one.get();
  }
  return nullptr;
}

const Enum* find_enum(const Spec& spec, const std::vector<std::string>& path) {
  if (path.size() == 2) return find_enum(spec, path[0]);
  const Spec* import = import_named(spec, path[0]);
  if (import == nullptr && find_type(spec, path[0]) != nullptr) return find_enum(spec, path[1]);
  return import == nullptr ? nullptr : find_enum(*import, path[1]);
}

void check_names(Check& check) {
  for (const auto& spec : check.model.specs) {
    DistinctNames types(check, "type"), enums(check, "enum");
    for (const auto& type : spec->types) types.add(type->id, type->place);
    for (const auto& one : spec->enums) {
      enums.add(one->id, one->place);
      check_enum(check, *one);
    }
    for (const auto& type : spec->types) {
      check_type_names(check, *type);
      for (Param& param : type->params) resolve_param(check, *spec, param);
      for (const auto& field : type->fields) resolve_field(check, *spec, *field);
      for (const auto& field : type->instances) resolve_field(check, *spec, *field);
    }
  }
}

}  // namespace rubricc
