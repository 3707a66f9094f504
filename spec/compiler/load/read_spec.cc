// Reads a file: meta, types, enums.
#include "spec/compiler/load/read_spec.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace rubricc {
namespace {

using Keys = std::span<const std::string_view>;
constexpr std::array<std::string_view, 12> kMetaKeys{
    "id",         "title",    "endian",      "license",        "imports", "ks-version",
    "bit-endian", "encoding", "application", "file-extension", "xref",    "tags"};
constexpr std::array<std::string_view, 13> kTopKeys{
    "meta",      "doc",   "doc-ref", "params",   "seq",      "types",       "enums",
    "instances", "-name", "-size",   "-am-type", "-carrier", "-requirement"};
constexpr std::array<std::string_view, 15> kTypeKeys{
    "doc",   "params", "doc-ref", "seq",      "instances", "types",    "enums",       "-name",
    "-size", "-mask",  "-crc",    "-am-type", "-carrier",  "-framing", "-requirement"};
constexpr std::array<std::string_view, 3> kCrcKeys{"polynomial", "initial", "order"};
constexpr std::array<std::string_view, 5> kParamKeys{"id", "type", "enum", "doc", "doc-ref"};
constexpr std::array<std::string_view, 2> kEnumValueKeys{"id", "doc"};
constexpr int kTypesDeep = 20;
constexpr std::int64_t kEnumValueMax = 0xFFFFFFFF;

std::string doc_ref(const YamlInput& input, const YamlMap& map) {
  const YamlEntry* entry = map.find("doc-ref");
  if (entry == nullptr) return {};
  if (!entry->value.IsSequence()) return one_line(map.text("doc-ref").value_or(""));
  std::string out;
  for (const YAML::Node& item : yaml_items(input, entry->value, "doc-ref")) {
    const auto text = yaml_text(input, item, "doc-ref");
    if (!text) continue;
    if (!out.empty()) out += "; ";
    out += one_line(*text);
  }
  return out;
}

void read_am_types(const YamlInput& input, const YamlMap& map, Type& type) {
  const YamlEntry* entry = map.find("-am-type");
  if (entry == nullptr) return;
  std::vector<YAML::Node> items{entry->value};
  if (entry->value.IsSequence()) items = yaml_items(input, entry->value, "-am-type");
  for (const YAML::Node& item : items) {
    const auto value = yaml_integer(input, item, "-am-type");
    if (!value) continue;
    if (*value < 0 || *value > 255) {
      input.error(item, fmt::format("AM type {}", *value), "0 to 255 was expected");
    } else if (std::find(type.am_types.begin(), type.am_types.end(), *value) !=
               type.am_types.end()) {
      input.error(item, fmt::format("AM type {} twice", *value), "each once");
    } else {
      type.am_types.push_back(*value);
    }
  }
}

void read_crc(const YamlInput& input, const YamlMap& map, Type& type) {
  const YamlEntry* entry = map.find("-crc");
  if (entry == nullptr) return;
  type.has_crc = true;
  const YamlMap crc(input, entry->value, "-crc", kCrcKeys);
  const bool ok = crc.integer("polynomial") == 0x1021 && crc.integer("initial") == 0 &&
                  crc.text("order") == "le";
  if (!ok) {
    input.error(entry->value, "a CRC that the framing code does not have",
                "polynomial 0x1021, initial 0, order le was expected");
  }
}

void read_bits(const YamlInput& input, const YamlMap& map, Type& type) {
  type.is_mask = true;
  const auto width = map.integer("-mask");
  const SourcePlace place = type.places.at("-mask");
  if (width && *width != 8 && *width != 16) {
    input.diagnostics.error(place, fmt::format("a mask of {} bits", *width),
                            "8 or 16 was expected");
  }
  if (const YamlEntry* seq = map.find("seq")) {
    for (const YAML::Node& item : yaml_items(input, seq->value, "seq")) {
      type.bits.push_back(read_mask_bit(input, item));
    }
  }
  const auto count = static_cast<std::int64_t>(type.bits.size());
  if (width && (*width == 8 || *width == 16) && count != *width) {
    input.diagnostics.error(place, fmt::format("{} bits in a mask of {}", count, *width),
                            "each bit is named once, from the highest down");
  }
  if (map.has("instances")) {
    input.error(map.find("instances")->key_node, "instances in a mask", "a mask has only bits");
  }
}

/// Returns the values of "u2" and other types that a parameter has.
std::optional<Interval> param_range(std::string_view word) {
  if (word == "bool") return Interval{0, 1};
  const auto width = parse_integer(word.substr(std::min<std::size_t>(1, word.size())));
  if (!width || *width < 1) return std::nullopt;
  if (word[0] == 'b' && *width <= 32) return Interval{0, (std::int64_t{1} << *width) - 1};
  if (*width != 1 && *width != 2 && *width != 4) return std::nullopt;
  const std::int64_t span = std::int64_t{1} << (8 * *width);
  if (word[0] == 'u') return Interval{0, span - 1};
  if (word[0] == 's') return Interval{-span / 2, span / 2 - 1};
  return std::nullopt;
}

void read_params(const YamlInput& input, const YamlMap& map, Type& type) {
  const YamlEntry* entry = map.find("params");
  if (entry == nullptr) return;
  for (const YAML::Node& item : yaml_items(input, entry->value, "params")) {
    const YamlMap keys(input, item, "a parameter", kParamKeys);
    Param param{.id = keys.text("id").value_or(""), .place = input.place(item)};
    check_id(input.diagnostics, param.place, param.id, "a parameter");
    const std::string word = keys.text("type").value_or("bytes");
    const auto range = param_range(word);
    if (!range) {
      input.error(keys.has("type") ? keys.find("type")->value : item,
                  fmt::format("a parameter of type {}", quote(word)),
                  "u1, u2, u4, s1, s2, s4, bool or b1 to b32 was expected");
    }
    param.range = range.value_or(Interval{0, 1});
    param.enum_name = keys.text("enum").value_or("");
    param.is_bool = word == "bool" || (word == "b1" && param.enum_name.empty());
    type.params.push_back(std::move(param));
  }
  if (type.params.size() > rubric::reflect::kMaxParams) {
    input.error(entry->value, fmt::format("too many parameters: {}", type.params.size()),
                fmt::format("at most {} are read", rubric::reflect::kMaxParams));
  }
}

void read_fields(const YamlInput& input, const YamlMap& map, const Spec& spec, Type& type) {
  read_params(input, map, type);
  if (const YamlEntry* seq = map.find("seq")) {
    for (const YAML::Node& item : yaml_items(input, seq->value, "seq")) {
      if (auto field = read_field(input, item, FieldPlace::kSeq, spec, nullptr)) {
        type.fields.push_back(std::move(field));
      }
    }
  }
  if (const YamlEntry* instances = map.find("instances")) {
    const YamlMap named(input, instances->value, "instances", Keys{});
    for (const YamlEntry& entry : named.entries()) {
      if (is_computed(entry.value)) {
        const SourcePlace place = input.place(entry.key_node);
        const std::string what = fmt::format("instance {} is computed", quote(entry.key));
        input.diagnostics.error_in_code(place, what, "a number or a type at pos was expected");
        input.diagnostics.note(place, what + "; it is not shown");
        type.computed.push_back(read_computed(input, entry));
        continue;
      }
      if (auto field = read_field(input, entry.value, FieldPlace::kInstance, spec, &entry)) {
        type.instances.push_back(std::move(field));
      }
    }
  }
}

/// Checks seq only if it is absent or []: errors in it were reported.
void check_seq(const YamlInput& input, const YamlMap& map, const Type& type) {
  const YamlEntry* seq = map.find("seq");
  const bool empty =
      seq == nullptr ? !map.refused_keys() : seq->value.IsSequence() && seq->value.size() == 0;
  if (!empty) return;
  input.diagnostics.error_in_code(type.place, fmt::format("type {} without fields", quote(type.id)),
                                  "seq: with a field was expected");
}

void read_type(const YamlInput& input, const YamlMap& map, const Spec& spec, Type& type) {
  type.places = places_of(input, map);
  type.refused_keys = map.refused_keys();
  type.name = map.text("-name").value_or(type.id);
  if (map.has("-name")) {
    check_id(input.diagnostics, type.places.at("-name"), type.name, "a shown name");
  }
  type.doc = one_line(map.text("doc").value_or(""));
  type.doc_ref = doc_ref(input, map);
  type.requirement = map.text("-requirement").value_or("");
  type.declared_size = map.integer("-size");
  type.carrier = map.text("-carrier").value_or("");
  type.framing = map.text("-framing").value_or("");
  read_am_types(input, map, type);
  read_crc(input, map, type);
  if (!type.framing.empty() && type.framing != "hdlc") {
    input.diagnostics.error(type.places.at("-framing"),
                            fmt::format("unknown framing {}", quote(type.framing)),
                            "known is hdlc");
  }
  if (input.budget >= 0 && map.is_map()) check_seq(input, map, type);
  if (map.has("-mask")) {
    read_bits(input, map, type);
  } else {
    read_fields(input, map, spec, type);
  }
}

void read_enum_value(const YamlInput& input, const YamlEntry& entry, Enum& out) {
  EnumEntry value{.place = input.place(entry.key_node)};
  const auto number = parse_integer(entry.key);
  if (!number || *number < 0 || *number > kEnumValueMax) {
    input.error(entry.key_node, fmt::format("enum value {}", quote(entry.key)),
                "a number of 0 to 0xffffffff was expected");
    return;
  }
  value.value = *number;
  if (entry.value.IsMap()) {
    const YamlMap map(input, entry.value, "an enum value", kEnumValueKeys);
    value.name = map.text("id").value_or("");
    value.doc = one_line(map.text("doc").value_or(""));
    if (!map.has("id")) input.error(entry.value, "an enum value without id", "id: was expected");
  } else {
    value.name = yaml_text(input, entry.value, "an enum value").value_or("");
  }
  if (value.name.empty()) return;
  check_id(input.diagnostics, input.place(entry.value), value.name, "");
  out.entries.push_back(std::move(value));
}

void read_enums(const YamlInput& input, const YamlEntry& enums, Spec& spec) {
  const YamlMap map(input, enums.value, "enums", Keys{});
  for (const YamlEntry& entry : map.entries()) {
    auto out = std::make_unique<Enum>();
    out->id = entry.key;
    out->spec = &spec;
    out->place = input.place(entry.key_node);
    check_id(input.diagnostics, out->place, out->id, "an enum");
    const YamlMap values(input, entry.value, "an enum", Keys{});
    for (const YamlEntry& value : values.entries()) read_enum_value(input, value, *out);
    spec.enums.push_back(std::move(out));
  }
}

void read_imports(const YamlInput& input, const YamlMap& meta, Spec& spec) {
  const YamlEntry* imports = meta.find("imports");
  if (imports == nullptr) return;
  for (const YAML::Node& item : yaml_items(input, imports->value, "imports")) {
    const auto name = yaml_text(input, item, "imports");
    if (!name) continue;
    spec.import_names.push_back(*name);
    spec.import_places.push_back(input.place(item));
  }
}

void read_meta(const YamlInput& input, const YAML::Node& root, const YamlMap& top, Spec& spec) {
  const YamlEntry* entry = top.find("meta");
  if (entry == nullptr) {
    input.error(root, "no meta", "a spec begins with meta: and its id");
    return;
  }
  const YamlMap meta(input, entry->value, "meta", kMetaKeys);
  spec.places = places_of(input, meta);
  spec.title = meta.text("title").value_or("");
  if (const auto id = meta.text("id")) {
    spec.id = *id;
    check_id(input.diagnostics, spec.places.at("id"), spec.id, "a spec");
  } else if (!meta.has("id")) {
    input.error(entry->key_node, "meta without id", "id: was expected");
  }
  if (const auto endian = meta.text("endian")) {
    spec.little_endian = *endian == "le";
    if (*endian != "le" && *endian != "be") {
      input.diagnostics.error(spec.places.at("endian"), "endian is " + quote(*endian),
                              "be or le was expected");
    }
  }
  spec.encoding = meta.text("encoding").value_or("");
  if (const auto order = meta.text("bit-endian")) {
    spec.lowest_bit_first = *order == "le";
    if (*order != "le" && *order != "be") {
      input.diagnostics.error(spec.places.at("bit-endian"), "bit-endian is " + quote(*order),
                              "be or le was expected");
    }
  }
  read_imports(input, meta, spec);
}

/// Reads types, and those within them as if they stood beside them.
void read_types(const YamlInput& input, const YamlEntry& types, Spec& spec, int depth) {
  const YamlMap map(input, types.value, "types", Keys{});
  for (const YamlEntry& entry : map.entries()) {
    auto type = std::make_unique<Type>();
    type->id = entry.key;
    type->spec = &spec;
    type->place = input.place(entry.key_node);
    check_id(input.diagnostics, type->place, type->id, "a type");
    const YamlMap keys(input, entry.value, "a type", kTypeKeys);
    read_type(input, keys, spec, *type);
    spec.types.push_back(std::move(type));
    const YamlEntry* inner = keys.find("types");
    const YamlEntry* enums = keys.find("enums");
    for (const YamlEntry* one : {inner, enums}) {
      if (one == nullptr) continue;
      input.diagnostics.error_in_code(input.place(one->key_node),
                                      fmt::format("{} within a type", one->key),
                                      "beside the others was expected");
    }
    if (enums != nullptr) read_enums(input, *enums, spec);
    if (inner != nullptr && depth < kTypesDeep) read_types(input, *inner, spec, depth + 1);
  }
}

}  // namespace

std::unique_ptr<Spec> read_spec(const std::string& file, const std::string& text,
                                Diagnostics& diagnostics, int& budget) {
  const auto root = parse_yaml(file, text, diagnostics);
  if (!root) return nullptr;
  const YamlInput input{file, diagnostics, budget};
  if (!root->IsMap()) {
    diagnostics.error(input.place(*root), "not a spec", "a mapping with meta: was expected");
    return nullptr;
  }
  auto spec = std::make_unique<Spec>();
  spec->file = file;
  const YamlMap top(input, *root, "a spec", kTopKeys);
  read_meta(input, *root, top, *spec);
  spec->doc = one_line(top.text("doc").value_or(""));
  spec->doc_ref = doc_ref(input, top);
  if (top.has("seq")) {
    auto type = std::make_unique<Type>();
    type->id = spec->id;
    type->spec = spec.get();
    type->place = place_of(spec->places, "id", input.place(top.find("seq")->key_node));
    read_type(input, top, *spec, *type);
    spec->types.push_back(std::move(type));
  }
  if (const YamlEntry* types = top.find("types")) read_types(input, *types, *spec, 0);
  if (const YamlEntry* enums = top.find("enums")) read_enums(input, *enums, *spec);
  return spec;
}

}  // namespace rubricc
