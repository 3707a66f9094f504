#include "conformance/trace/protocol.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <utility>

#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/suggest.h"
#include "codec/text/yaml.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

constexpr std::uint32_t kU1 = 0xFF;
constexpr std::uint32_t kU2 = 0xFFFF;
constexpr std::uint32_t kU4 = 0xFFFFFFFF;
constexpr std::uint32_t kAmPayloadMax = 114;
constexpr const char* kTypes = "u1, u2, u4, f4, bytes, address, channel";

template <class Table>
const Table* find_table(const Table* const* tables, std::size_t count, std::string_view name) {
  const auto* const found =
      std::find_if(tables, tables + count, [&](const Table* one) { return one->name == name; });
  return found == tables + count ? nullptr : *found;
}

bool has_message(const reflect::Protocol& wire, std::string_view name) {
  for (int i = 0; i < wire.carrier_count; ++i) {
    const reflect::Switch* choice = reflect::payload_choice(wire, wire.carriers[i].name);
    for (int k = 0; choice && k < choice->count; ++k) {
      if (choice->cases[k].type->name == name) return true;
    }
  }
  return false;
}

/// Reads an app.yaml; throws at the first mistake.
class AppReader {
 public:
  AppReader(const std::string& file, const FindWire& find_wire)
      : file_(file), find_wire_(find_wire) {}

  Protocol read(const YAML::Node& root) {
    keys(root, "a protocol",
         {"protocol", "wire", "roles", "profiles", "frames", "enums", "parameters", "calls",
          "events"});
    out_.name = word(need(root, "protocol", "a protocol"));
    wire(need(root, "wire", "a protocol"));
    for (const auto& [key, value] : entries(need(root, "roles", "a protocol"))) role(key, value);
    if (out_.roles.empty()) fail(root, "a protocol without a role");
    out_.profiles = words(at(root, "profiles"));
    if (const YAML::Node frames = at(root, "frames")) {
      keys(frames, "frames", {"broadcast", "whole_on_serial", "on_peis"});
      out_.broadcast = messages(at(frames, "broadcast"));
      out_.whole_on_serial = messages(at(frames, "whole_on_serial"));
      out_.on_peis = messages(at(frames, "on_peis"));
    }
    for (const auto& [key, value] : entries(at(root, "enums"))) enumeration(key, value);
    for (const auto& [key, value] : entries(at(root, "parameters"))) parameter(key, value);
    for (const auto& [key, value] : entries(at(root, "calls"))) message(AppWhat::kCall, key, value);
    for (const auto& [key, value] : entries(at(root, "events")))
      message(AppWhat::kEvent, key, value);
    add_messages_of_links();
    return std::move(out_);
  }

 private:
  using Entries = std::vector<std::pair<YAML::Node, YAML::Node>>;

  [[noreturn]] void fail(const YAML::Node& node, const std::string& what) const {
    const YAML::Mark at = node.Mark();
    throw std::runtime_error(file_ + ':' + std::to_string(std::max(at.line, 0) + 1) + ':' +
                             std::to_string(std::max(at.column, 0) + 1) + ": " + what);
  }

  void wire(const YAML::Node& node) {
    try {
      const bool scalar = node.IsScalar() || node.IsNull();
      out_.wire = &find_wire_(scalar ? node.Scalar() : text(node));
    } catch (const std::invalid_argument& mistake) {
      fail(node, mistake.what());
    }
    for (int i = 0; i < out_.wire->type_count; ++i) {
      const reflect::Type& type = *out_.wire->types[i];
      const auto* const end = type.fields + type.field_count;
      const auto* const wide = std::find_if(
          type.fields, end, [](const reflect::Field& field) { return field.is_wide(); });
      if (wide == end) continue;
      fail(node, std::string(type.id) + '.' + wide->name +
                     " has 64 bits; traces hold numbers below 2^63, so 's8' or 'size: 8'");
    }
  }

  // Here alone, as the compiler makes a map[] of its own for each length of a written key.
  static YAML::Node at(const YAML::Node& map, const char* key) { return map[key]; }

  YAML::Node need(const YAML::Node& map, const char* key, const std::string& what) const {
    const YAML::Node found = at(map, key);
    if (!found) fail(map, what + " without " + quoted(key));
    return found;
  }

  // Returns the entries of a mapping, in their order; none where it is absent or empty.
  Entries entries(const YAML::Node& node) const {
    Entries out;
    if (!node || node.IsNull()) return out;
    if (!node.IsMap()) fail(node, "expected a mapping");
    for (const auto& pair : node) {
      const std::string key = word(pair.first);
      const bool twice = std::any_of(out.begin(), out.end(),
                                     [&](const auto& one) { return one.first.Scalar() == key; });
      if (twice) fail(pair.first, quoted(key) + " is given twice");
      out.emplace_back(pair.first, pair.second);
    }
    return out;
  }

  void keys(const YAML::Node& node, const char* what,
            std::initializer_list<const char*> known) const {
    if (!node.IsMap()) fail(node, std::string("expected the keys of ") + what);
    for (const auto& [key, value] : entries(node)) {
      if (std::find(known.begin(), known.end(), key.Scalar()) != known.end()) continue;
      std::string names;
      for (const char* name : known) names += (names.empty() ? "" : ", ") + std::string(name);
      fail(key, quoted(key.Scalar()) + " is no key of " + what + "; known are " + names);
    }
  }

  std::string text(const YAML::Node& node) const {
    if (!node.IsScalar() || node.Scalar().empty()) fail(node, "expected a text");
    return node.Scalar();
  }

  std::string word(const YAML::Node& node) const {
    const std::string out = text(node);
    if (!is_name(out)) fail(node, "expected a name of letters, digits and _, given " + quoted(out));
    return out;
  }

  std::vector<std::string> words(const YAML::Node& node) const {
    std::vector<std::string> out;
    if (!node) return out;
    if (!node.IsSequence()) fail(node, "expected a list, as [a, b]");
    for (const YAML::Node& item : node) out.push_back(word(item));
    return out;
  }

  std::vector<std::string> messages(const YAML::Node& node) const {
    std::vector<std::string> out = words(node);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!has_message(*out_.wire, out[i])) {
        fail(node[i], quoted(out[i]) + " is no message of " + out_.wire->id);
      }
    }
    return out;
  }

  std::int64_t number(const YAML::Node& node, std::int64_t max) const {
    std::int64_t out = 0;
    if (!node.IsScalar() || !read_integer(node.Scalar(), out) || out < 0 || out > max) {
      fail(node, "expected a number from 0 to " + std::to_string(max));
    }
    return out;
  }

  void role(const YAML::Node& key, const YAML::Node& node) {
    keys(node, "a role", {"links", "has", "doc"});
    RoleInfo one{.name = word(key)};
    const YAML::Node links = need(node, "links", "a role");
    for (const std::string& link : words(links)) {
      if (link == "radio") {
        one.radio = true;
      } else if (link == "serial") {
        one.serial = true;
      } else if (link == "peis") {
        one.peis = true;
      } else {
        fail(links, "expected radio, serial or peis, given " + quoted(link));
      }
    }
    if (const YAML::Node has = at(node, "has")) {
      one.has_id = false;
      for (const std::string& what : words(has)) {
        if (what == "id") {
          one.has_id = true;
        } else if (what == "island") {
          one.has_island = true;
        } else {
          fail(has, "expected id or island, given " + quoted(what));
        }
      }
    }
    out_.roles.push_back(std::move(one));
  }

  void enumeration(const YAML::Node& key, const YAML::Node& node) {
    auto one = std::make_unique<AppEnum>();
    if (!node.IsMap() || node.size() == 0) fail(key, "an enum has numbers with their names");
    for (const auto& pair : node) {
      const auto value = static_cast<std::uint32_t>(number(pair.first, kU4));
      if (!one->names.emplace(value, word(pair.second)).second) {
        fail(pair.first, "a number is given twice");
      }
      const bool twice =
          std::ranges::count(one->names, one->names[value],
                             &std::pair<const std::uint32_t, std::string>::second) > 1;
      if (twice) fail(pair.second, "a name is given twice");
    }
    for (const auto& [value, name] : one->names) one->entries.push_back({value, name.c_str()});
    const auto [at, fresh] = out_.enums.emplace(word(key), std::move(one));
    AppEnum& kept = *at->second;
    kept.table = {at->first.c_str(), kept.entries.data(),
                  static_cast<std::uint16_t>(kept.entries.size())};
  }

  void parameter(const YAML::Node& key, const YAML::Node& node) {
    keys(node, "a parameter", {"unit", "min", "max", "unstated", "decision", "doc"});
    Parameter one{.id = static_cast<ParameterId>(out_.parameters.size()), .name = word(key)};
    for (const char* const taken : {"id", "island", "seed", "profile", "iut", "whole"}) {
      if (one.name == taken) fail(key, quoted(taken) + " has a meaning in all protocols");
    }
    one.unit = text(need(node, "unit", "a parameter"));
    one.doc = text(need(node, "doc", "a parameter"));
    one.min = number(need(node, "min", "a parameter"), kU4);
    one.max = number(need(node, "max", "a parameter"), kU4);
    if (one.max < one.min) fail(node, "max is less than min");
    // Where there are profiles, these have the values of nodes that state none.
    const YAML::Node unstated =
        out_.profiles.empty() ? need(node, "unstated", "a parameter") : at(node, "unstated");
    if (unstated) one.unstated = number(unstated, one.max);
    if (unstated && one.unstated < one.min) fail(unstated, "unstated is less than min");
    if (const YAML::Node decision = at(node, "decision")) {
      one.decision = static_cast<int>(number(decision, kU2));
    }
    if (out_.parameters.size() == kU1) fail(key, "more than 255 parameters");
    out_.parameters.push_back(std::move(one));
  }

  void message(AppWhat what, const YAML::Node& key, const YAML::Node& node) {
    AppMessage one{word(key), what};
    const bool twice = std::any_of(out_.messages.begin(), out_.messages.end(),
                                   [&](const AppMessage& other) { return other.name == one.name; });
    if (twice) fail(key, quoted(one.name) + " is given twice");
    for (const auto& [name, type] : entries(node)) {
      one.fields.push_back(field(type));
      one.fields.back().name = word(name);
    }
    check_name(key);
    out_.messages.push_back(std::move(one));
  }

  void check_name(const YAML::Node& key) const {
    if (has_message(*out_.wire, key.Scalar())) {
      fail(key, quoted(key.Scalar()) + " is a message of " + out_.wire->id + ", too");
    }
    for (const AppMessage& one : messages_of_links()) {
      if (one.name == key.Scalar()) fail(key, quoted(one.name) + " has a meaning in all protocols");
    }
  }

  AppField field(const YAML::Node& node) const {
    if (node.IsScalar()) return field_of(node);
    keys(node, "a field", {"type", "enum", "max"});
    AppField out = field_of(need(node, "type", "a field"));
    if (const YAML::Node names = at(node, "enum")) {
      out.names = names_of(text(names));
      if (!out.names) fail(names, "no enum " + quoted(names.Scalar()));
    }
    if (const YAML::Node max = at(node, "max")) {
      out.max = static_cast<std::uint32_t>(number(max, out.max));
    }
    return out;
  }

  // Makes a field of a type, of an enum of this file, or of a mask of the wire spec.
  AppField field_of(const YAML::Node& node) const {
    const std::string type = text(node);
    if (type == "u1") return {"", AppKind::kNumber, kU1};
    if (type == "u2") return {"", AppKind::kNumber, kU2};
    if (type == "u4") return {"", AppKind::kNumber, kU4};
    if (type == "f4") return {"", AppKind::kReal};
    if (type == "bytes") return {"", AppKind::kBytes};
    if (type == "address") return {"", AppKind::kAddress};
    if (type == "channel") return {"", AppKind::kChannel};
    if (const auto own = out_.enums.find(type); own != out_.enums.end()) {
      return {"", AppKind::kNumber, own->second->names.rbegin()->first, &own->second->table};
    }
    if (const auto* const mask = find_table(out_.wire->masks, out_.wire->mask_count, type)) {
      return {"", AppKind::kNumber, mask->width_bits == 8 ? kU1 : kU2, nullptr, mask};
    }
    std::vector<std::string> names;
    for (const auto& [name, one] : out_.enums) names.push_back(name);
    fail(node, "unknown type " + quoted(type) + reflect::did_you_mean(type, names) +
                   "; known are " + kTypes + ", enums of this file, masks of " + out_.wire->id);
  }

  const reflect::EnumTable* names_of(const std::string& name) const {
    const auto own = out_.enums.find(name);
    if (own != out_.enums.end()) return &own->second->table;
    return find_table(out_.wire->enums, out_.wire->enum_count, name);
  }

  // Returns what every protocol has: states of a link, the power of a node, and a frame that
  // nothing decodes.
  std::vector<AppMessage> messages_of_links() const {
    return {{"busy", AppWhat::kState},
            {"idle", AppWhat::kState},
            {"linkack", AppWhat::kRadio, {{"acked", AppKind::kNumber, 1}}},
            {"reboot", AppWhat::kPower},
            {"off", AppWhat::kPower},
            {kFrameName,
             AppWhat::kFrame,
             {{"type", AppKind::kNumber, kU1, names_of("am_type")},
              {"payload", AppKind::kBytes},
              {"size", AppKind::kNumber, kAmPayloadMax, nullptr, nullptr, true}}}};
  }
  void add_messages_of_links() {
    for (AppMessage& one : messages_of_links()) out_.messages.push_back(std::move(one));
  }

  const std::string& file_;
  const FindWire& find_wire_;
  Protocol out_;
};

Protocol read_rubicon() {
  const auto& [name, text] = *embedded_protocol().begin();
  Protocol out = read_protocol(text, name, [](const std::string&) -> const reflect::Protocol& {
    return rubicon::tables::kProtocol;
  });
  out.has_machine = true;
  return out;
}

std::optional<Protocol>& slot() {
  static std::optional<Protocol> other;
  return other;
}

}  // namespace

Protocol read_protocol(const std::string& text, const std::string& file,
                       const FindWire& find_wire) {
  YAML::Node root;
  try {
    root = text::only_yaml_document(text);
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(file + ':' + std::to_string(error.mark.line + 1) + ':' +
                             std::to_string(error.mark.column + 1) + ": " + error.msg);
  }
  return AppReader(file, find_wire).read(root);
}

const Protocol& protocol() {
  if (slot()) return *slot();
  static const Protocol own = read_rubicon();
  return own;
}

void use(Protocol other) { slot() = std::move(other); }

bool is_among(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
    out += words[i];
  }
  return out;
}

std::vector<std::string> role_names() {
  std::vector<std::string> out;
  for (const RoleInfo& role : protocol().roles) out.push_back(role.name);
  return out;
}

}  // namespace rubric::trace
