// Emits doc/wire.json: the checked model for programs that print it, such as the book. Schema
// rubricc.model/1; leaves out keys that do not apply to a thing.
#include <nlohmann/json.hpp>

#include "spec/compiler/emit/emit.h"
#include "spec/compiler/load/read_spec.h"
#include "spec/compiler/model.h"

namespace rubricc {
namespace {

using Json = nlohmann::ordered_json;

void put(Json& out, const char* key, const std::string& text) {
  if (!text.empty()) out[key] = text;
}

void put(Json& out, const char* key, const ExprPtr& expr) {
  if (expr) out[key] = to_text(*expr);
}

/// "rubicon::net_msg": names of types and enums are unique within a spec only.
template <typename Named>
std::string full_name(const Named& one) {
  return one.spec->id + "::" + one.id;
}

Json size_of(std::uint32_t min, std::uint32_t max) {
  Json out{{"min", min}};
  if (max != UINT32_MAX) out["max"] = max;  // Else unbounded.
  return out;
}

Json choice_of(const Switch& choice) {
  Json cases = Json::array();
  for (const SwitchCase& one : choice.cases) {
    cases.push_back({{"value", to_text(*one.key_expr)}, {"type", full_name(*one.type)}});
  }
  Json out{{"key", to_text(*choice.key)}, {"cases", std::move(cases)}};
  if (choice.otherwise) out["otherwise"] = full_name(*choice.otherwise->type);
  return out;
}

/// By ValueKind.
constexpr const char* kKinds[] = {"unsigned", "signed", "float", "", "mask", "bytes", "struct"};

void put_values(Json& out, const Field& field) {
  if (field.valid && !field.valid->one_of.empty()) {
    out["valid"] = {{"one_of", field.valid->one_of}};
  } else if (field.valid) {
    Json range;
    if (field.valid->min) range["min"] = *field.valid->min;
    if (field.valid->max) range["max"] = *field.valid->max;
    out["valid"] = std::move(range);
  }
  if (field.expect) out["expect"] = *field.expect;
  if (field.unit) {
    out["unit"] = {{"symbol", field.unit->symbol},
                   {"scale", field.unit->scale},
                   {"offset", field.unit->offset}};
  }
}

Json field_of(const Field& field, const Type& type) {
  Json out{{"id", field.id}, {"name", field.name}};
  put(out, "doc", field.doc);
  put(out, "doc_ref", field.doc_ref);
  put(out, "requirement", field.requirement);
  out["kind"] = kKinds[static_cast<std::size_t>(field.kind)];
  if (field.width_bytes > 0) {
    out["width_bytes"] = field.width_bytes;
    out["little_endian"] = field.little_endian;
  }
  if (field.type != nullptr) out["type"] = full_name(*field.type);
  if (field.choice) out["choice"] = choice_of(*field.choice);
  if (field.enumeration != nullptr) out["enum"] = full_name(*field.enumeration);
  if (field.repeat != RepeatKind::kOnce) {
    out["repeat"] = field.repeat == RepeatKind::kCount ? "count" : "to_end";
  }
  put(out, "count", field.count);
  if (field.extent == ExtentKind::kToEnd) out["to_end"] = true;
  put(out, "size_expr", field.size);
  put(out, "if", field.condition);
  put_values(out, field);
  if (field.fixed_offset >= 0) out["offset"] = field.fixed_offset;
  out["size"] = size_of(field.min_size, field.max_size);
  if (field.is_instance) {
    out["overlays"] = type.fields[static_cast<std::size_t>(field.overlays)]->id;
  }
  return out;
}

Json type_of(const Type& type) {
  Json out{
      {"id", type.id}, {"name", type.name}, {"spec", type.spec->id}, {"line", type.place.line}};
  put(out, "doc", type.doc);
  put(out, "doc_ref", type.doc_ref);
  put(out, "requirement", type.requirement);
  out["size"] = size_of(type.min_size, type.max_size);
  out["am_types"] = type.am_types;
  put(out, "carrier", type.carrier);
  put(out, "framing", type.framing);
  if (type.is_mask) {
    Json bits = Json::array();
    for (std::size_t i = 0; i < type.bits.size(); ++i) {
      Json bit{{"bit", type.bits.size() - 1 - i}};
      if (!type.bits[i].unnamed) bit["name"] = type.bits[i].name;
      bits.push_back(std::move(bit));
    }
    out["bits"] = std::move(bits);
    return out;
  }
  out["fields"] = Json::array();
  for (const auto& field : type.fields) out["fields"].push_back(field_of(*field, type));
  Json instances = Json::array();
  for (const auto& one : type.instances) {
    if (!one->is_peek) instances.push_back(field_of(*one, type));
  }
  if (!instances.empty()) out["interpretations"] = std::move(instances);
  return out;
}

Json enum_of(const Enum& one) {
  Json entries = Json::array();
  for (const EnumEntry& entry : one.entries) {
    Json value{{"value", entry.value}, {"name", entry.name}};
    put(value, "doc", entry.doc);
    entries.push_back(std::move(value));
  }
  return {{"id", one.id}, {"spec", one.spec->id}, {"entries", std::move(entries)}};
}

Json spec_of(const Spec& spec) {
  Json out{{"id", spec.id}, {"file", spec.file}};
  put(out, "title", spec.title);
  put(out, "doc", spec.doc);
  put(out, "doc_ref", spec.doc_ref);
  out["types"] = Json::array();
  for (const auto& type : spec.types) out["types"].push_back(type_of(*type));
  out["enums"] = Json::array();
  for (const auto& one : spec.enums) out["enums"].push_back(enum_of(*one));
  return out;
}

Json requirement_of(const Requirement& one) {
  Json out{{"id", one.id},         {"level", one.level},
           {"clause", one.clause}, {"sentence", one.sentence},
           {"source", one.source}, {"line", one.place.line}};
  out["roles"] = Json::array();
  const std::pair<int, const char*> roles[] = {{1, "mote"}, {2, "sink"}, {4, "base station"}};
  for (const auto& [bit, name] : roles) {
    if ((one.roles & bit) != 0) out["roles"].push_back(name);
  }
  out["forbids"] = one.forbids;
  put(out, "deployed", one.deployed);
  return out;
}

Json profile_of(const Profile& profile) {
  Json constants = Json::object(), switches = Json::object(), accepted = Json::object();
  for (std::size_t i = 0; i < profile_fields().size(); ++i) {
    const ProfileField& field = profile_fields()[i];
    const std::string name(field.name);
    if (field.is_switch) {
      switches[name] = profile.values.at(i) != 0;
    } else {
      constants[name] = profile.values.at(i);
    }
  }
  for (const AcceptedDifference& one : profile.accepted) accepted[one.requirement] = one.sentence;
  return {{"name", profile.name},
          {"file", profile.file},
          {"doc", profile.doc},
          {"constants", std::move(constants)},
          {"switches", std::move(switches)},
          {"accepted", std::move(accepted)}};
}

}  // namespace

GeneratedFiles emit_json(const Model& model) {
  Json out{{"schema", "rubricc.model/1"}};
  for (const char* key : {"specs", "requirements", "profiles", "case_uses"}) {
    out[key] = Json::array();
  }
  for (const auto& spec : model.specs) out["specs"].push_back(spec_of(*spec));
  for (const Requirement& one : model.requirements) {
    out["requirements"].push_back(requirement_of(one));
  }
  for (const Profile& one : model.profiles) out["profiles"].push_back(profile_of(one));
  for (const CaseUse& one : model.case_uses) {
    out["case_uses"].push_back({{"case", one.case_name},
                                {"file", one.file},
                                {"requirement", one.requirement},
                                {"negative", one.negative}});
  }
  return {{"doc/wire.json", out.dump(1) + "\n"}};
}

}  // namespace rubricc
