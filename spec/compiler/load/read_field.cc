// Reads one field, instance or bit of a mask.
#include <fmt/core.h>
#include <iconv.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

constexpr std::array<std::string_view, 21> kSeqKeys{
    "repeat-until", "id",       "type",       "enum",      "size",      "size-eos", "repeat",
    "repeat-expr",  "if",       "valid",      "contents",  "doc",       "doc-ref",  "-name",
    "-requirement", "encoding", "terminator", "eos-error", "pad-right", "-unit",    "-expect"};
constexpr std::array<std::string_view, 9> kInstanceKeys{
    "pos", "type", "enum", "size-eos", "if", "doc", "doc-ref", "-name", "-requirement"};
constexpr std::array<std::string_view, 4> kBitKeys{"id", "type", "doc", "-unnamed"};
constexpr std::array<std::string_view, 5> kValidKeys{"eq", "min", "max", "any-of", "in-enum"};
constexpr std::array<std::string_view, 3> kUnitKeys{"symbol", "scale", "offset"};
constexpr int kBitsMax = 32;
constexpr std::array<std::string_view, 2> kSwitchKeys{"switch-on", "cases"};

/// Sets "u2le" and similar types; returns false for every other word.
bool set_number(const YamlInput& input, const YAML::Node& node, std::string_view word,
                const Spec& spec, Field& field) {
  std::string_view base = word.substr(0, 2);
  const std::string_view suffix = word.size() > 2 ? word.substr(2) : std::string_view{};
  if (base.size() != 2 || std::string_view("usf").find(base[0]) == base.npos) return false;
  if (std::string_view("1248").find(base[1]) == base.npos) return false;
  if (base[0] == 'f' && base[1] != '4') return false;
  if (!suffix.empty() && suffix != "be" && suffix != "le") return false;
  field.kind = base[0] == 'u' ? ValueKind::kUint : ValueKind::kSint;
  if (base[0] == 'f') field.kind = ValueKind::kFloat;
  field.width_bytes = base[1] - '0';
  if (field.width_bytes == 1) {
    if (!suffix.empty()) input.error(node, "a byte order for one byte", "u1 or s1 was expected");
    return true;
  }
  field.little_endian = suffix.empty() ? spec.little_endian : suffix == "le";
  if (suffix.empty() && !spec.places.contains("endian")) {
    input.error(node, fmt::format("no byte order for {}", quote(word)),
                "meta: endian, or the suffix be or le was expected");
  }
  return true;
}

/// Encodings that iconv(3) reads, in which a character does not depend on those before it.
constexpr std::array<std::string_view, 14> kCharsets{
    "ISO-8859-", "WINDOWS-", "IBM",  "UTF-16LE", "UTF-16BE",  "UTF-32LE", "UTF-32BE",
    "CP",        "KOI8-",    "EUC-", "GB",       "SHIFT_JIS", "SJIS",     "BIG5"};

bool knows_charset(const std::string& word) {
  if (!std::any_of(kCharsets.begin(), kCharsets.end(),
                   [&](std::string_view begin) { return word.starts_with(begin); })) {
    return false;
  }
  const auto is_part = [](char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  if (!std::all_of(word.begin(), word.end(), is_part)) return false;
  const iconv_t open = iconv_open("UTF-8", word.c_str());
  if (open == reinterpret_cast<iconv_t>(-1)) return false;
  iconv_close(open);
  return true;
}

void set_encoding(const YamlInput& input, const YamlMap& map, const Spec& spec, Text& text) {
  const auto own = map.text("encoding");
  std::string word = own.value_or(spec.encoding);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  text.encoding = word == "UTF-8" ? Encoding::kUtf8 : Encoding::kAscii;
  if (word == "UTF-8" || word == "ASCII") return;
  if (knows_charset(word)) {
    text.encoding = Encoding::kOther;
    text.charset = word;
    text.unit = word.starts_with("UTF-16") ? 2 : word.starts_with("UTF-32") ? 4 : 1;
    return;
  }
  const std::string what = word.empty() ? "text without encoding" : "the encoding " + quote(word);
  input.error(
      own ? map.find("encoding")->value : map.find("type")->value, what,
      "known are ASCII, UTF-8, UTF-16LE, UTF-16BE, ISO-8859-1, windows-1252 and others that "
      "iconv -l names");
}

/// Sets "b12" and similar types; returns false for every other word.
bool set_bits(const YamlInput& input, const YAML::Node& node, std::string_view word,
              const Spec& spec, Field& field) {
  if (word.size() < 2 || word[0] != 'b') return false;
  const auto width = parse_integer(word.substr(1));
  if (!width) return false;
  field.kind = ValueKind::kUint;
  field.little_endian = spec.lowest_bit_first;
  field.bit_width = static_cast<int>(std::clamp<std::int64_t>(*width, 1, kBitsMax));
  if (field.bit_width != *width) {
    input.error(node, fmt::format("a number of {} bits", *width),
                fmt::format("1 to {} were expected", kBitsMax));
  }
  return true;
}

/// Reads what "str", "strz" and a terminator of bytes have.
void read_text(const YamlInput& input, const YamlMap& map, const Spec& spec, Field& field) {
  const auto type =
      map.has("type") && !map.find("type")->value.IsMap() ? map.text("type") : std::nullopt;
  const bool is_text = type == "str" || type == "strz";
  if (!is_text) {
    for (const char* key : {"encoding", "terminator", "eos-error", "pad-right"}) {
      const bool bytes = key != std::string_view("encoding") && !map.has("type");
      if (!map.has(key) || bytes) continue;
      input.error(map.find(key)->key_node, fmt::format("{} of a number or structure", quote(key)),
                  "text or bytes was expected");
    }
    if (map.has("type") || !(map.has("terminator") || map.has("pad-right"))) return;
  }
  Text text;
  if (is_text) set_encoding(input, map, spec, text);
  for (const char* key : {"terminator", "pad-right"}) {
    if (text.unit == 1 || !map.has(key)) continue;
    input.error(map.find(key)->key_node, fmt::format("{} of {}", quote(key), text.charset),
                "its characters have more than a byte; strz ends with one that is 0");
  }
  const auto byte = [&](const char* key, int otherwise) {
    const auto value = map.integer(key);
    if (!value) return otherwise;
    if (*value >= 0 && *value <= 255) return static_cast<int>(*value);
    input.error(map.find(key)->value, fmt::format("{} is {}", quote(key), *value),
                "a byte was expected");
    return otherwise;
  };
  text.terminator = byte("terminator", type == "strz" ? 0 : -1);
  text.padding = byte("pad-right", -1);
  text.may_lack_its_end = !map.boolean("eos-error").value_or(true);
  field.text = text;
  if (text.terminator >= 0 && field.extent == ExtentKind::kOwn) {
    field.extent = ExtentKind::kTerminated;
  }
}

/// Returns where the text of a scalar begins.
SourcePlace place_of_text(const YamlInput& input, const YAML::Node& node) {
  SourcePlace place = input.place(node);
  if (node.Tag() == "!") ++place.column;  // After the quote.
  return place;
}

/// Reads "part(length, 3)": the name of a type, and what its parameters are.
std::string read_call(const YamlInput& input, const YAML::Node& node, const std::string& word,
                      std::vector<ExprPtr>& arguments) {
  const std::size_t open = word.find('(');
  if (open == word.npos) return word;
  if (!word.ends_with(')')) {
    input.error(node, "a bracket is not closed", "')' was expected at the end");
    return word.substr(0, open);
  }
  int depth = 0;
  for (std::size_t from = open + 1, at = from; at < word.size(); ++at) {
    const bool ends = depth == 0 && (word[at] == ',' || at + 1 == word.size());
    depth += (word[at] == '(') - (word[at] == ')' && !ends);
    if (!ends) continue;
    SourcePlace place = place_of_text(input, node);
    while (from < at && word[from] == ' ') ++from;
    place.column += static_cast<int>(from);
    auto expr = parse_expr(word.substr(from, at - from), place, input.diagnostics);
    if (expr) arguments.push_back(std::move(expr));
    from = at + 1;
  }
  return word.substr(0, open);
}

std::unique_ptr<Switch> read_switch(const YamlInput& input, const YAML::Node& node) {
  const YamlMap map(input, node, "a type by switch", kSwitchKeys);
  auto out = std::make_unique<Switch>();
  out->place = input.place(node);
  if (const YamlEntry* key = map.find("switch-on")) {
    out->place = input.place(key->value);
    out->key = read_expr(input, key->value, "switch-on");
  } else {
    input.error(node, "a type without switch-on", "a type, or switch-on and cases was expected");
  }
  const YamlEntry* cases = map.find("cases");
  if (cases == nullptr) {
    input.error(node, "a switch without cases", "cases: was expected");
    return out;
  }
  const YamlMap entries(input, cases->value, "cases", std::span<const std::string_view>{});
  if (entries.entries().empty()) input.error(cases->value, "a switch without cases", "");
  for (const YamlEntry& entry : entries.entries()) {
    SwitchCase found{.place = input.place(entry.key_node)};
    const auto type = yaml_text(input, entry.value, "the type of a case");
    if (!type) continue;
    found.type_name = read_call(input, entry.value, *type, found.arguments);
    if (entry.key == "_") {
      out->otherwise = std::move(found);
      continue;
    }
    found.key_expr = read_expr(input, entry.key_node, "a case");
    if (found.key_expr) out->cases.push_back(std::move(found));
  }
  return out;
}

void read_type_of(const YamlInput& input, const YamlMap& map, const Spec& spec, Field& field) {
  const YamlEntry* entry = map.find("type");
  if (entry == nullptr) return;
  if (entry->value.IsMap()) {
    field.kind = ValueKind::kStruct;
    field.choice = read_switch(input, entry->value);
    return;
  }
  const auto word = yaml_text(input, entry->value, "type");
  if (!word || set_number(input, entry->value, *word, spec, field)) return;
  if (*word == "str" || *word == "strz" || set_bits(input, entry->value, *word, spec, field))
    return;
  field.kind = ValueKind::kStruct;
  field.type_name = read_call(input, entry->value, *word, field.arguments);
}

void read_valid(const YamlInput& input, const YamlMap& map, Field& field) {
  const YamlEntry* entry = map.find("valid");
  if (entry == nullptr) return;
  Valid valid{.place = input.place(entry->value)};
  const auto add = [&](const YAML::Node& node) {
    if (auto expr = read_expr(input, node, "valid")) valid.one_of_exprs.push_back(std::move(expr));
  };
  if (entry->value.IsMap()) {
    const YamlMap bounds(input, entry->value, "valid", kValidKeys);
    if (const YamlEntry* eq = bounds.find("eq")) add(eq->value);
    if (const YamlEntry* any = bounds.find("any-of")) {
      for (const YAML::Node& item : yaml_items(input, any->value, "any-of")) add(item);
      if (valid.one_of_exprs.empty()) input.error(any->value, "no value is valid", "");
    }
    if (const YamlEntry* min = bounds.find("min")) {
      valid.min_expr = read_expr(input, min->value, "min");
    }
    if (const YamlEntry* max = bounds.find("max")) {
      valid.max_expr = read_expr(input, max->value, "max");
    }
    valid.in_enum = bounds.boolean("in-enum").value_or(false);
    const bool range = bounds.has("min") || bounds.has("max");
    const int kinds = range + bounds.has("eq") + bounds.has("any-of") + bounds.has("in-enum");
    if (kinds != 1) {
      input.error(entry->value, "valid mixes rules or has none",
                  "one of eq, any-of, in-enum, or min and max was expected");
    }
  } else {
    add(entry->value);
  }
  field.valid = std::move(valid);
}

/// Turns `contents` of a number's size into a number with one valid value.
void read_contents(const YamlInput& input, const YamlMap& map, Field& field) {
  const YamlEntry* entry = map.find("contents");
  if (entry == nullptr) return;
  std::string bytes;
  std::vector<YAML::Node> items{entry->value};
  if (entry->value.IsSequence()) items = yaml_items(input, entry->value, "contents");
  for (const YAML::Node& item : items) {
    const auto word = yaml_text(input, item, "contents");
    if (!word) return;
    const auto number = parse_integer(*word);
    if (!number) {
      bytes += *word;
    } else if (*number >= 0 && *number <= 255) {
      bytes += static_cast<char>(*number);
    } else {
      input.error(item, fmt::format("{} in contents", *number), "a byte was expected");
      return;
    }
  }
  if (bytes.empty() || bytes.size() > 4) {
    input.error(entry->value, fmt::format("contents of {} bytes", bytes.size()),
                "1 to 4 bytes are read as one number");
    return;
  }
  for (const char* other : {"type", "size", "size-eos", "valid", "enum", "repeat"}) {
    if (!map.has(other)) continue;
    input.error(map.find(other)->key_node, fmt::format("{} beside contents", quote(other)),
                "contents stand alone");
  }
  field.kind = ValueKind::kUint;
  field.width_bytes = static_cast<int>(bytes.size());
  if (bytes.size() == 3) field.bit_width = 24;  // No number of whole bytes has that size.
  std::int64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  Valid valid{.place = input.place(entry->value)};
  valid.one_of.push_back(value);
  field.valid = std::move(valid);
}

void read_repeat(const YamlInput& input, const YamlMap& map, Field& field) {
  const YamlEntry* count = map.find("repeat-expr");
  if (count != nullptr) field.count = read_expr(input, count->value, "repeat-expr");
  const auto repeat = map.text("repeat");
  const auto until = map.text("repeat-until");
  if (repeat == "expr") {
    field.repeat = RepeatKind::kCount;
    if (count == nullptr) {
      input.error(map.find("repeat")->value, "repeat: expr without a count",
                  "repeat-expr: was expected");
    }
  } else if (repeat == "eos" || (repeat == "until" && until == "_io.eof")) {
    field.repeat = RepeatKind::kToEnd;
  } else if (repeat == "until") {
    field.repeat = RepeatKind::kUntil;
    const YamlEntry* entry = map.find("repeat-until");
    if (entry != nullptr) field.until = read_expr(input, entry->value, "repeat-until");
    if (entry == nullptr) {
      input.error(map.find("repeat")->value, "repeat: until without a condition",
                  "repeat-until: was expected");
    }
  } else if (repeat) {
    input.error(map.find("repeat")->value, "repeat is " + quote(*repeat),
                "expr, eos or until was expected");
  }
  if (count != nullptr && repeat != "expr") {
    input.error(count->key_node, "repeat-expr without repeat: expr", "");
  }
  if (until && repeat != "until") {
    input.error(map.find("repeat-until")->key_node, "repeat-until without repeat: until", "");
  }
}

void read_extent(const YamlInput& input, const YamlMap& map, Field& field) {
  if (const YamlEntry* size = map.find("size")) {
    field.size = read_expr(input, size->value, "size");
    field.extent = ExtentKind::kSize;
  }
  const auto to_end = map.boolean("size-eos");
  if (map.has("size-eos") && !to_end) field.refused_keys = true;
  if (to_end.value_or(false)) {
    if (map.has("size")) {
      input.error(map.find("size-eos")->key_node, "size-eos beside size", "one of both");
    }
    field.extent = ExtentKind::kToEnd;
  }
}

double read_real(const YamlInput& input, const YamlMap& map, std::string_view key, double absent) {
  const auto word = map.text(key);
  if (!word) return absent;
  double value = 0;
  const char* const end = word->data() + word->size();
  const auto [at, fault] = std::from_chars(word->data(), end, value);
  if (fault == std::errc() && at == end && value > -1e12 && value < 1e12) return value;
  input.error(map.find(key)->value, fmt::format("{} is {}", quote(key), quote(*word)),
              "a decimal number was expected");
  return absent;
}

void read_unit(const YamlInput& input, const YamlMap& map, Field& field) {
  const YamlEntry* entry = map.find("-unit");
  if (entry == nullptr) return;
  const YamlMap unit(input, entry->value, "-unit", kUnitKeys);
  Unit out{.symbol = unit.text("symbol").value_or(""),
           .scale = read_real(input, unit, "scale", 1),
           .offset = read_real(input, unit, "offset", 0)};
  if (out.symbol.empty()) {
    input.error(entry->value, "a unit without symbol", "symbol: was expected");
  }
  field.unit = out;
}

void read_docs(const YamlMap& map, Field& field) {
  field.doc = one_line(map.text("doc").value_or(""));
  if (map.has("doc-ref") && !map.find("doc-ref")->value.IsSequence()) {
    field.doc_ref = one_line(map.text("doc-ref").value_or(""));
  }
  field.requirement = map.text("-requirement").value_or("");
}

}  // namespace

bool is_computed(const YAML::Node& instance) {
  if (!instance.IsMap()) return false;
  for (const auto& pair : instance) {
    if (!pair.first.IsScalar()) continue;
    const std::string& key = pair.first.Scalar();
    if (key == "value" || key == "io" || key == "size" || key == "repeat") return true;
    if (key == "pos" && pair.second.IsScalar() && !parse_integer(pair.second.Scalar())) return true;
  }
  return false;
}

Computed read_computed(const YamlInput& input, const YamlEntry& entry) {
  Computed out{.id = entry.key};
  if (!entry.value.IsMap() || entry.value["if"]) return out;
  const YAML::Node value = entry.value["value"];
  const YAML::Node names = entry.value["enum"];
  if (value && value.IsScalar()) {
    out.text = value.Scalar();
    out.place = place_of_text(input, value);
  }
  if (names && names.IsScalar()) out.enum_name = names.Scalar();
  return out;
}

ExprPtr read_expr(const YamlInput& input, const YAML::Node& node, std::string_view what) {
  const auto text = yaml_text(input, node, what);
  return text ? parse_expr(*text, place_of_text(input, node), input.diagnostics) : nullptr;
}

KeyPlaces places_of(const YamlInput& input, const YamlMap& map) {
  KeyPlaces out;
  for (const YamlEntry& entry : map.entries()) out[entry.key] = input.place(entry.value);
  return out;
}

const SourcePlace& place_of(const KeyPlaces& places, std::string_view key,
                            const SourcePlace& otherwise) {
  const auto found = places.find(key);
  return found == places.end() ? otherwise : found->second;
}

std::unique_ptr<Field> read_field(const YamlInput& input, const YAML::Node& node, FieldPlace where,
                                  const Spec& spec, const YamlEntry* instance) {
  const bool in_seq = where == FieldPlace::kSeq;
  const YamlMap map(input, node, in_seq ? "a field" : "an instance",
                    in_seq ? std::span<const std::string_view>(kSeqKeys)
                           : std::span<const std::string_view>(kInstanceKeys));
  if (!node.IsMap()) return nullptr;
  auto field = std::make_unique<Field>();
  field->places = places_of(input, map);
  field->refused_keys = map.refused_keys();
  field->place = input.place(instance != nullptr ? instance->key_node : node);
  field->is_instance = !in_seq;
  if (instance != nullptr) {
    field->id = instance->key;
  } else if (const auto id = map.text("id")) {
    field->id = *id;
    field->place = field->places.at("id");
  } else {
    if (!map.has("id")) input.error(node, "a field without id", "id: was expected");
    return nullptr;
  }
  check_id(input.diagnostics, field->place, field->id, "a field");
  field->name = map.text("-name").value_or(field->id);
  if (map.has("-name")) {
    check_id(input.diagnostics, field->places.at("-name"), field->name, "a shown name");
  }
  read_docs(map, *field);
  read_type_of(input, map, spec, *field);
  read_extent(input, map, *field);
  if (in_seq) read_text(input, map, spec, *field);
  read_repeat(input, map, *field);
  read_valid(input, map, *field);
  read_contents(input, map, *field);
  read_unit(input, map, *field);
  field->enum_name = map.text("enum").value_or("");
  if (const YamlEntry* entry = map.find("if")) {
    field->condition = read_expr(input, entry->value, "if");
  }
  if (const YamlEntry* entry = map.find("-expect")) {
    field->expect_expr = read_expr(input, entry->value, "-expect");
  }
  if (!in_seq) {
    const auto position = map.integer("pos");
    field->position = position.value_or(-1);
    if (!position) field->places.erase("pos");  // Its value was reported.
    field->is_peek = field->kind != ValueKind::kStruct && field->extent == ExtentKind::kOwn;
    if (!map.has("pos")) input.error(instance->key_node, "an instance without pos", "");
  }
  return field;
}

MaskBit read_mask_bit(const YamlInput& input, const YAML::Node& node) {
  const YamlMap map(input, node, "a bit of a mask", kBitKeys);
  MaskBit bit{.name = map.text("id").value_or(""),
              .unnamed = map.boolean("-unnamed").value_or(false)};
  if (!map.has("id")) {
    input.error(node, "a bit without id", "id: was expected");
  } else {
    check_id(input.diagnostics, input.place(map.find("id")->value), bit.name, "a bit");
  }
  if (map.text("type") != "b1") {
    input.error(map.has("type") ? map.find("type")->value : node, "a mask has only bits",
                "type: b1 was expected");
  }
  return bit;
}

}  // namespace rubricc
