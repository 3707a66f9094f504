#include "tools/format/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "codec/reflect/suggest.h"
#include "codec/reflect/text_field.h"
#include "tools/format/json_nodes.h"
#include "tools/format/message_types.h"

namespace rubric::format {

using reflect::Decoded;
using reflect::Field;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;
using reflect::Protocol;
using reflect::Repeat;
using reflect::Type;

namespace {

constexpr std::size_t kMaxComponents = 16;

template <class Call>
void for_each_field(const Protocol& protocol, Call call) {
  for (const Type* type : message_types(protocol)) {
    for (int i = 0; i < type->field_count; ++i) call(*type, type->fields[i]);
    for (int i = 0; i < type->interpretation_count; ++i) {
      call(*type, type->interpretations[i].field);
    }
  }
}

bool is_name_of(const Node& node, const std::string& name) {
  if (node.field && name == node.field->name) return true;
  const Type* type = node.kind == NodeKind::kStructArray ? node.field->type : node.type;
  return type && name == type->name;
}

constexpr std::size_t kMaxPathDepth = 2 * Decoded::kMaxPath;
struct Around {  // The structures around a node, from the outside in.
  std::size_t nodes[kMaxPathDepth];
  std::size_t depth = 0;
};

// Returns whether the structures around a node have the names in `components` (without the last).
bool encloses(const Decoded& decoded, const Around& around,
              const std::vector<std::string>& components) {
  std::size_t depth = around.depth;
  for (std::size_t k = components.size() - 1; k-- > 0;) {
    if (depth == 0 || !is_name_of(decoded[around.nodes[--depth]], components[k])) return false;
  }
  return true;
}

}  // namespace

Path::Path(std::string_view text, const Protocol& protocol) : text_(text), protocol_(&protocol) {
  attribute_ = find_attribute(text);
  if (attribute_) return;
  std::string_view rest = text.starts_with("fields.") ? text.substr(7) : text;
  while (true) {
    const std::size_t dot = rest.find('.');
    components_.emplace_back(rest.substr(0, dot));
    if (dot == std::string_view::npos) break;
    rest.remove_prefix(dot + 1);
  }
  const std::vector<std::string> known = known_names(protocol);
  const auto refuse = [&](const std::string& word) {
    const std::string of_frame = "frame." + word;
    throw PathError(fmt::format("unknown name '{}'{}", word,
                                find_attribute(of_frame)
                                    ? fmt::format(" (did you mean '{}'?)", of_frame)
                                    : reflect::did_you_mean(word, known)));
  };
  if (components_.size() > kMaxComponents) throw PathError("path is too long");
  std::set<const Type*> elements;
  for_each_field(protocol, [&](const Type&, const Field& f) {
    if (f.kind == Kind::kStruct && f.repeat != Repeat::kOnce) elements.insert(f.type);
  });
  for_each_field(protocol, [&](const Type& owner, const Field& f) {
    const bool list =
        elements.contains(&owner) || (f.kind != Kind::kStruct && f.repeat != Repeat::kOnce);
    add_targets(f, components_.back(), list);
  });
  for (const Type* type : message_types(protocol)) {
    if (components_.back() == type->name) {
      targets_.push_back({nullptr, type, Beside::kNothing, false});
    }
  }
  if (targets_.empty()) refuse(components_.size() > 1 ? text_ : components_.back());
  for (const std::string& component : components_) {
    const bool last = &component == &components_.back();
    if (!last && std::find(known.begin(), known.end(), component) == known.end()) refuse(component);
  }
}

void Path::add_targets(const Field& field, std::string_view name, bool list) {
  const std::string_view own = field.name;
  if (name == own) {
    targets_.push_back({&field, nullptr, Beside::kNothing, list});
  } else if (name.size() > own.size() + 1 && name.starts_with(own) && name[own.size()] == '_') {
    const std::string_view suffix = name.substr(own.size() + 1);
    if (field.enumeration && suffix == "name") {
      targets_.push_back({&field, nullptr, Beside::kName, list});
    } else if (field.mask && suffix == "bits") {
      targets_.push_back({&field, nullptr, Beside::kBits, list});
    } else if (field.unit && suffix == field.unit->symbol) {
      targets_.push_back({&field, nullptr, Beside::kUnit, list});
    }
  }
}

const Path::Target* Path::target(const Node& node) const {
  for (const Target& target : targets_) {
    if (target.field && target.field == node.field) return &target;
    if (target.type && target.type == node.type) return &target;
  }
  return nullptr;
}

namespace {

Value of_number(const Field& field, std::int64_t raw) {
  Value value{.kind = Value::Kind::kInteger, .integer = raw, .field = &field};
  if (field.kind == Kind::kFloat) {
    value.kind = Value::Kind::kReal;
    value.real = static_cast<double>(float_of_bits(static_cast<std::uint32_t>(raw)));
  } else if (field.enumeration) {
    const char* name = reflect::enum_name(*field.enumeration, raw);
    if (name) value.text = name;
  }
  return value;
}

}  // namespace

// Passes on a target's form of the field's raw number.
bool Path::show(const Target& target, std::int64_t raw, Visitor visit) {
  Value value = of_number(*target.field, raw);
  switch (target.beside) {
    case Beside::kNothing: break;
    case Beside::kName:
      if (value.text.empty()) return true;
      value = Value::of_text(value.text);
      break;
    case Beside::kBits: value.kind = Value::Kind::kBits; break;
    case Beside::kUnit:
      value.real = converted(*target.field, raw);
      if (value.kind == Value::Kind::kReal) value.field = nullptr;  // It is no binary32 any more.
      if (value.kind == Value::Kind::kInteger) value.kind = Value::Kind::kUnit;
      break;
  }
  return visit(value);
}

bool Path::show_node(const Target& target, const Decoded& decoded, std::size_t index,
                     Visitor visit) {
  const Node& node = decoded[index];
  if (node.kind == NodeKind::kNumber) return show(target, node.value, visit);
  if (node.kind == NodeKind::kNumberArray) {
    const std::uint8_t* at = decoded.bytes.data() + node.offset;
    for (std::uint32_t k = 0; k < node.count; ++k, at += node.field->width_bytes) {
      if (!show(target, reflect::load_number(*node.field, at), visit)) return false;
    }
    return true;
  }
  if (is_text(node.field)) {
    const std::string text =
        reflect::shown_text(*node.field, decoded.bytes.sub(node.offset, node.size));
    return visit(Value::of_text(text));
  }
  Value value = Value::of_bytes(decoded.bytes.sub(node.offset, node.size));
  value.field = node.field;
  value.node = index;
  if (node.kind != NodeKind::kBytes) value.kind = Value::Kind::kNode;
  return visit(value);
}

void Path::find(const Record& record, bool first_only, Visitor visit) const {
  const Decoded& decoded = record.decoded();
  if (decoded.node_count() == 0 || !record.frame->has_payload) return;
  const std::size_t root = record.frame->payload_node;
  Around around;
  const Target* found = nullptr;
  for (std::size_t i = root; i < decoded[root].end; ++i) {
    const Node& node = decoded[i];
    while (around.depth && i >= decoded[around.nodes[around.depth - 1]].end) --around.depth;
    // An element of an array has its array's field, which counts once.
    const bool element = around.depth &&
                         decoded[around.nodes[around.depth - 1]].kind == NodeKind::kStructArray &&
                         decoded[around.nodes[around.depth - 1]].field == node.field;
    if (element) continue;
    const Target* here = target(node);
    if (here && (!first_only || !found || here == found) &&
        encloses(decoded, around, components_)) {
      found = here;
      if (!show_node(*here, decoded, i, visit)) return;
    }
    const bool structure = node.kind == NodeKind::kStruct || node.kind == NodeKind::kStructArray;
    if (structure && around.depth < kMaxPathDepth) around.nodes[around.depth++] = i;
  }
}

void Path::visit(const Record& record, Visitor visit) const {
  if (attribute_) {
    attribute_->visit(record, visit);
  } else {
    find(record, false, visit);
  }
}

void Path::visit_first(const Record& record, Visitor visit) const {
  if (attribute_) {
    attribute_->visit(record, visit);
  } else {
    find(record, true, visit);
  }
}

bool Path::is_list() const {
  if (attribute_) return attribute_->name == "path" || attribute_->name == "notes";
  return std::any_of(targets_.begin(), targets_.end(), [](const Target& t) { return t.list; });
}

std::vector<std::string> Path::names() const {
  std::vector<std::string> names;
  if (attribute_) {
    if (attribute_->names) attribute_->names(*protocol_, names);
    return names;
  }
  for (const Target& target : targets_) {
    if (!target.field || !target.field->enumeration) continue;
    const reflect::EnumTable& table = *target.field->enumeration;
    for (int i = 0; i < table.count; ++i) names.emplace_back(table.entries[i].name);
  }
  return names;
}

std::vector<std::string> Path::bit_names() const {
  std::vector<std::string> names;
  for (const Target& target : targets_) {
    if (!target.field || !target.field->mask) continue;
    const reflect::MaskTable& mask = *target.field->mask;
    for (int bit = 0; bit < mask.width_bits; ++bit) {
      names.emplace_back(mask.bit_names[bit] ? mask.bit_names[bit] : fmt::format("bit{}", bit));
    }
  }
  return names;
}

bool Path::is_free_text() const {
  if (attribute_) return attribute_->free_text;
  return std::any_of(targets_.begin(), targets_.end(), [](const Target& target) {
    return target.field && target.field->kind == Kind::kBytes;
  });
}

bool Path::is_bytes() const {
  if (attribute_) return attribute_->name == "raw" || attribute_->name == "stale";
  return std::all_of(targets_.begin(), targets_.end(), [](const Target& target) {
    return target.field && target.field->kind == Kind::kBytes && !is_text(target.field);
  });
}

std::vector<Path> parse_paths(std::string_view list, const Protocol& protocol) {
  std::vector<Path> paths;
  while (true) {
    const std::size_t comma = list.find(',');
    std::string_view word = list.substr(0, comma);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    paths.emplace_back(word, protocol);
    if (comma == std::string_view::npos) return paths;
    list.remove_prefix(comma + 1);
  }
}

std::vector<std::string> known_names(const Protocol& protocol) {
  std::set<std::string> names;
  for (const std::string_view name : attribute_names()) names.emplace(name);
  for_each_field(protocol, [&](const Type&, const Field& f) {
    names.emplace(f.name);
    if (f.enumeration) names.emplace(fmt::format("{}_name", f.name));
    if (f.mask) names.emplace(fmt::format("{}_bits", f.name));
    if (f.unit) names.emplace(fmt::format("{}_{}", f.name, f.unit->symbol));
  });
  for (const Type* type : message_types(protocol)) names.emplace(type->name);
  names.emplace("payload");
  return {names.begin(), names.end()};
}

}  // namespace rubric::format
