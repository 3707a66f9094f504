// Reflection tables: one constant after another, each named after what it describes.
//   enums::kPid, masks::kTransducerMask, types::kNetMsg    what a table points to
//   of::net_msg::kPayloadSize                              parts of one type's table
#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "spec/compiler/diagnostics.h"
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/emit/tables/built_tables.h"
#include "spec/compiler/model.h"

namespace rubricc {
namespace {

/// Names in codec/reflect/schema.h, in the order there.
constexpr std::string_view kOpNames[] = {
    "kConst", "kLoadU8", "kLoadBe16", "kLoadLe16", "kLoadBe32", "kLoadLe32", "kAdd",
    "kSub",   "kMul",    "kDiv",      "kMod",      "kEq",       "kNe",       "kLt",
    "kLe",    "kGt",     "kGe",       "kAnd",      "kOr",       "kNot"};
constexpr std::string_view kKindNames[] = {"kUint", "kSint",  "kFloat", "kBits",
                                           "kMask", "kBytes", "kStruct"};
constexpr std::string_view kRepeatNames[] = {"kOnce", "kCount", "kToEnd", "kUntil"};
constexpr std::string_view kExtentNames[] = {"kOwn", "kSize", "kToEnd", "kTerminated"};

/// Returns "Kind::kUint".
template <class Enum, std::size_t kCount>
std::string name_in(const std::string_view (&names)[kCount], std::string_view type, Enum value) {
  return fmt::format("{}::{}", type, names[static_cast<std::size_t>(value)]);
}

constexpr std::string_view kTablesFile = R"(<<banner>>
#pragma once

<<includes>>

namespace rubric {
namespace <<spec>> {
namespace tables {

using reflect::Carrier;
using reflect::EnumEntry;
using reflect::EnumTable;
using reflect::Expr;
using reflect::ExprStep;
using reflect::Extent;
using reflect::Field;
using reflect::Interpretation;
using reflect::Kind;
using reflect::MaskTable;
using reflect::Op;
using reflect::Protocol;
using reflect::Repeat;
using reflect::Switch;
using reflect::SwitchCase;
using reflect::Type;
using reflect::Unit;
using reflect::Valid;
using reflect::ValidKind;

constexpr Valid kAny{ValidKind::kAny, 0, 0, nullptr, 0};

<<blocks>>

<<lists?>>
constexpr Protocol kProtocol{
<<protocol>>};

}  // namespace tables
}  // namespace <<spec>>
}  // namespace rubric
)";

constexpr std::string_view kEnum = R"(namespace of {
namespace <<id>> {
constexpr EnumEntry kEntries[] = {
<<entries>>};
}  // namespace <<id>>
}  // namespace of
namespace enums {
constexpr EnumTable <<name>>{<<shown>>, of::<<id>>::kEntries, <<count>>};
}  // namespace enums
)";
constexpr std::string_view kMask = R"(namespace of {
namespace <<id>> {
constexpr const char* kBits[] = {
<<bits>>};
}  // namespace <<id>>
}  // namespace of
namespace masks {
constexpr MaskTable <<name>>{<<shown>>, of::<<id>>::kBits, <<width>>};
}  // namespace masks
)";
constexpr std::string_view kType = R"(<<comment?>>
namespace of {
namespace <<id>> {
<<parts?>>
<<fields?>>
<<interpretations?>>
}  // namespace <<id>>
}  // namespace of
namespace types {
constexpr Type <<name>>{
<<values>>};
}  // namespace types
)";

std::string qualified(const Spec& here, const Spec& there, std::string_view group,
                      std::string_view id) {
  const std::string local = fmt::format("{}::{}", group, cpp_constant(id));
  return &here == &there ? local : fmt::format("::rubric::{}::tables::{}", there.id, local);
}

/// The tables of one type: parts (expressions, switches, ...) first, then fields, then the type.
class TypeTables {
 public:
  TypeTables(const Spec& spec, const Type& type) : spec_(spec), type_(type) {}

  std::string text() {
    std::string fields, interpretations;
    for (const auto& field : type_.fields) fields += "    {" + wrapped(*field, 5) + "},\n";
    std::size_t shown = 0;
    for (const auto& instance : type_.instances) {
      if (instance->is_peek) continue;
      interpretations += "    {{" + wrapped(*instance, 6) + "},\n     " +
                         std::to_string(instance->overlays) + "},\n";
      ++shown;
    }
    if (!fields.empty()) fields = "constexpr Field kFields[] = {\n" + fields + "};";
    if (!interpretations.empty()) {
      interpretations =
          "constexpr Interpretation kInterpretations[] = {\n" + interpretations + "};";
    }
    const std::string comment = fmt::format("// {}: {}.", type_.id, size_text());
    return fill(kType, {{"comment", comment},
                        {"id", type_.id},
                        {"parts", parts_},
                        {"fields", fields},
                        {"interpretations", interpretations},
                        {"name", cpp_constant(type_.id)},
                        {"values", type_values(shown)}});
  }

 private:
  std::string size_text() const {
    if (type_.max_size == UINT32_MAX) return fmt::format("{} bytes and more", type_.min_size);
    if (type_.constant_size()) return bytes_text(type_.min_size);
    return fmt::format("{} to {} bytes", type_.min_size, type_.max_size);
  }

  std::string part(const Field& field, std::string_view what) const {
    return fmt::format("k{}{}", pascal(field.id), what);
  }

  void add_part(std::string declaration, const std::vector<std::string>& words) {
    const std::string values = wrap(words, 4);
    const bool fits = declaration.size() + values.size() < 86 && values.find('\n') == values.npos;
    parts_ +=
        "constexpr " + declaration + (fits ? "{" + values.substr(4) : "{\n" + values) + "};\n";
  }

  std::string expr(const Field& field, const ExprPtr& tree, std::string_view what) {
    if (!tree) return "{}";
    const auto steps = postfix(*tree);
    std::vector<std::string> words;
    for (const auto& step : steps) {
      words.push_back(fmt::format("{{{}, {}}}", name_in(kOpNames, "Op", step.op), step.value));
    }
    const std::string name = part(field, what);
    add_part(fmt::format("ExprStep {}[] = ", name), words);
    return fmt::format("{{{}, {}}}", name, steps.size());
  }

  std::string valid(const Field& field) {
    if (!field.valid) return "kAny";
    const Valid& rule = *field.valid;
    if (rule.one_of.empty()) {
      return fmt::format("{{ValidKind::kRange, {}, {}, nullptr, 0}}", cpp_int(*rule.min),
                         cpp_int(*rule.max));
    }
    std::vector<std::string> words;
    for (const std::int64_t value : rule.one_of) words.push_back(cpp_int(value));
    const std::string name = part(field, "OneOf");
    add_part(fmt::format("int64_t {}[] = ", name), words);
    return fmt::format("{{ValidKind::kOneOf, 0, 0, {}, {}}}", name, words.size());
  }

  std::string type_ref(const Type* type) const {
    return type == nullptr ? "nullptr" : "&" + qualified(spec_, *type->spec, "types", type->id);
  }

  std::string choice(const Field& field) {
    if (!field.choice) return "nullptr";
    const std::string key = expr(field, field.choice->key, "Key");
    std::vector<std::string> words;
    for (const SwitchCase& one : field.choice->cases) {
      words.push_back(fmt::format("{{{}, {}}}", cpp_int(one.key), type_ref(one.type)));
    }
    std::string cases = "nullptr";
    if (!words.empty()) {
      cases = part(field, "Cases");
      add_part(fmt::format("SwitchCase {}[] = ", cases), words);
    }
    const std::string otherwise =
        type_ref(field.choice->otherwise ? field.choice->otherwise->type : nullptr);
    add_part(fmt::format("Switch {}", part(field, "Switch")),
             {key, cases, std::to_string(words.size()), otherwise});
    return "&" + part(field, "Switch");
  }

  std::string unit(const Field& field) {
    if (!field.unit) return "nullptr";
    add_part(fmt::format("Unit {}", part(field, "Unit")),
             {cpp_string(field.unit->symbol), fmt::format("{}", field.unit->scale),
              fmt::format("{}", field.unit->offset)});
    return "&" + part(field, "Unit");
  }

  std::string mask(const Field& field) const {
    if (field.kind != ValueKind::kMask) return "nullptr";
    return "&" + qualified(spec_, *field.type->spec, "masks", field.type->id);
  }

  std::string enumeration(const Field& field) const {
    if (field.enumeration == nullptr) return "nullptr";
    return "&" + qualified(spec_, *field.enumeration->spec, "enums", field.enumeration->id);
  }

  /// In the order of reflect::Field.
  std::vector<std::string> field_values(const Field& field) {
    const std::string key = "\"" + field.name + "\":";
    const bool is_struct = field.kind == ValueKind::kStruct;
    return {cpp_string(field.name),
            cpp_string(key),
            std::to_string(key.size()),
            name_in(kKindNames, "Kind", field.kind),
            std::to_string(field.width_bytes),
            field.little_endian ? "true" : "false",
            name_in(kRepeatNames, "Repeat", field.repeat),
            name_in(kExtentNames, "Extent", field.extent),
            std::to_string(field.fixed_offset),
            valid(field),
            field.expect ? cpp_int(*field.expect) : "-1",
            enumeration(field),
            mask(field),
            is_struct ? type_ref(field.type) : "nullptr",
            choice(field),
            expr(field, field.size, "Size"),
            expr(field, field.count, "Count"),
            expr(field, field.condition, "If"),
            cpp_rule(field.requirement),
            unit(field)};
  }

  std::string wrapped(const Field& field, std::size_t indent) {
    std::vector<std::string> words = field_values(field);
    const auto doc = cpp_string_pieces(field.doc, 92 - indent);
    words.push_back(doc[0]);
    std::string text = wrap(words, indent).substr(indent);
    for (std::size_t i = 1; i < doc.size(); ++i) text += "\n" + std::string(indent, ' ') + doc[i];
    return text;
  }

  std::string type_values(std::size_t interpretations) const {
    const std::string of = fmt::format("of::{}::", type_.id);
    const std::int64_t am_type = type_.am_types.empty() ? -1 : type_.am_types.front();
    std::string out = wrap(
        {cpp_string(type_.id), cpp_string(type_.name),
         type_.fields.empty() ? "nullptr" : of + "kFields", std::to_string(type_.fields.size()),
         interpretations == 0 ? "nullptr" : of + "kInterpretations",
         std::to_string(interpretations), std::to_string(type_.min_size),
         type_.max_size == UINT32_MAX ? "UINT32_MAX" : std::to_string(type_.max_size),
         std::to_string(am_type), cpp_rule(type_.requirement)},
        4);
    for (const std::string* text : {&type_.doc, &type_.doc_ref}) {
      out += ",";
      for (const std::string& piece : cpp_string_pieces(*text, 92)) out += "\n    " + piece;
    }
    return out;
  }

  const Spec& spec_;
  const Type& type_;
  std::string parts_;
};

std::string enum_table(const Enum& one) {
  std::vector<std::string> words;
  for (const EnumEntry& entry : one.entries) {
    words.push_back(fmt::format("{{{}, {}}}", entry.value, cpp_string(entry.name)));
  }
  return fill(kEnum, {{"id", one.id},
                      {"entries", wrap(words, 4)},
                      {"name", cpp_constant(one.id)},
                      {"shown", cpp_string(one.id)},
                      {"count", std::to_string(words.size())}});
}

std::string mask_table(const Type& type) {
  std::vector<std::string> words;
  for (auto bit = type.bits.rbegin(); bit != type.bits.rend(); ++bit) {
    words.push_back(bit->unnamed ? "nullptr" : cpp_string(bit->name));
  }
  return fill(kMask, {{"id", type.id},
                      {"bits", wrap(words, 4)},
                      {"name", cpp_constant(type.id)},
                      {"shown", cpp_string(type.name)},
                      {"width", std::to_string(words.size())}});
}

/// The lists that kProtocol points to, and its values.
struct SpecLists {
  std::string text;
  std::vector<std::string> values;

  void add(std::string_view declaration, std::string_view name,
           const std::vector<std::string>& words) {
    if (!words.empty()) {
      text += fmt::format("constexpr {} {}[] = {{\n{}}};\n", declaration, name, wrap(words, 4));
    }
    values.push_back(words.empty() ? "nullptr" : std::string(name));
    values.push_back(std::to_string(words.size()));
  }
};

SpecLists lists_of(const Spec& spec) {
  std::vector<std::string> types, enums, masks, carriers;
  for (const auto& type : spec.types) {
    if (type->is_mask) {
      masks.push_back("&masks::" + cpp_constant(type->id));
      continue;
    }
    types.push_back("&types::" + cpp_constant(type->id));
    if (type->carrier.empty()) continue;
    carriers.push_back(
        fmt::format("{{{}, &types::{}}}", cpp_string(type->carrier), cpp_constant(type->id)));
  }
  for (const auto& one : spec.enums) enums.push_back("&enums::" + cpp_constant(one->id));
  SpecLists out;
  out.values = {cpp_string(spec.id), cpp_string(spec.title)};
  out.add("const Type*", "kTypes", types);
  out.add("const EnumTable*", "kEnums", enums);
  out.add("const MaskTable*", "kMasks", masks);
  out.add("Carrier", "kCarriers", carriers);
  return out;
}

}  // namespace

GeneratedFiles emit_tables(const Spec& spec) {
  std::string includes;
  std::vector<std::string> blocks;
  for (const Spec* import : spec.imports) {
    includes += cpp_include("codec/generated/" + import->id + "/tables.h") + "\n";
  }
  includes += cpp_include("codec/reflect/schema.h");
  for (const auto& one : spec.enums) blocks.push_back(enum_table(*one));
  for (const auto& type : spec.types) {
    if (type->is_mask) blocks.push_back(mask_table(*type));
  }
  for (const Type* type : spec.dependency_order) {
    if (!type->is_mask) blocks.push_back(TypeTables(spec, *type).text());
  }
  if (blocks.empty()) blocks.push_back("// Nothing is described.");
  const SpecLists lists = lists_of(spec);
  const std::string text =
      fill(kTablesFile, {{"banner", banner("// ", spec.file)},
                         {"includes", includes},
                         {"spec", spec.id},
                         {"blocks", fmt::format("{}", fmt::join(blocks, "\n"))},
                         {"lists", lists.text},
                         {"protocol", wrap(lists.values, 4)}});
  return {{fmt::format("codec/generated/{}/tables.h", spec.id), text}};
}

}  // namespace rubricc
