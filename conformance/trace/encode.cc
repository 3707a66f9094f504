#include "conformance/trace/encode.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "codec/reflect/decode.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/schema.h"
#include "codec/reflect/text_field.h"
#include "codec/reflect/value.h"
#include "conformance/trace/match.h"
#include "conformance/trace/protocol.h"
#include "conformance/trace/schema.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

using Tree = reflect::Value;
using reflect::Field;
using reflect::Type;

/// Decisions with several answers, tried one after the other: a body's type depends on fields that
/// are filled in as well.
class Choices {
 public:
  /// Returns the answer to the next question, from 0 to count - 1.
  std::size_t take(std::size_t count);
  /// Advances to the next combination of answers; returns false if there is none.
  bool next();

 private:
  struct Choice {
    std::size_t answer;
    std::size_t count;
  };
  std::vector<Choice> all_;
  std::size_t used_ = 0;
};

Tree* find(Tree& tree, std::string_view name) {
  for (std::size_t i = 0; i < tree.keys.size(); ++i) {
    if (tree.keys[i] == name) return &tree.items[i];
  }
  return nullptr;
}

std::vector<const Type*> types_of(const Field& field) {
  std::vector<const Type*> types;
  const auto add = [&](const Type* type) {
    if (type && std::find(types.begin(), types.end(), type) == types.end()) types.push_back(type);
  };
  add(field.type);
  if (field.choice) {
    add(field.choice->otherwise);
    for (int i = 0; i < field.choice->count; ++i) add(field.choice->cases[i].type);
  }
  return types;
}

/// Returns the member in which the encoder takes the exact bytes of a field of characters.
std::string exact_bytes_of(std::string_view field) { return std::string(field) + "_hex"; }

bool has_fields(const Type& type, const Tree& tree) {
  return std::all_of(tree.keys.begin(), tree.keys.end(), [&](const std::string& key) {
    const auto named = [&](const Field& f) {
      return key == f.name || (reflect::holds_characters(f) && key == exact_bytes_of(f.name));
    };
    return std::any_of(type.fields, type.fields + type.field_count, named) ||
           std::any_of(type.interpretations, type.interpretations + type.interpretation_count,
                       [&](const reflect::Interpretation& one) { return named(one.field); });
  });
}

void fill(const Type& type, Tree& tree, Choices& choices);

void fill_structure(const Field& field, Tree& tree, Choices& choices) {
  std::vector<const Type*> types = types_of(field);
  std::erase_if(types, [&](const Type* type) { return !has_fields(*type, tree); });
  if (!types.empty()) fill(*types[choices.take(types.size())], tree, choices);
}

/// Adds the member for the bytes of a field that bodies may overlay. The interpretations that share
/// its name are alternatives.
bool fill_body(const Type& type, const Field& field, Tree& tree, Choices& choices) {
  std::vector<const reflect::Interpretation*> bodies;
  for (int i = 0; i < type.interpretation_count; ++i) {
    const reflect::Interpretation& one = type.interpretations[i];
    if (&type.fields[one.overlays] != &field) continue;
    Tree* body = find(tree, one.field.name);
    if (!body || !body->is(Tree::Kind::kObject)) continue;
    std::vector<const Type*> types = types_of(one.field);
    const auto fits = [&](const Type* t) { return has_fields(*t, *body); };
    if (std::any_of(types.begin(), types.end(), fits)) bodies.push_back(&one);
  }
  if (bodies.empty()) return false;
  const reflect::Interpretation& chosen = *bodies[choices.take(bodies.size())];
  fill_structure(chosen.field, *find(tree, chosen.field.name), choices);
  return true;
}

Tree elements(const Field& field) {
  std::vector<Tree> items;
  // The encoder fills in a count that reads other fields; it does not fill in a constant one.
  if (field.repeat == reflect::Repeat::kCount && field.count.count == 1 &&
      field.count.steps[0].op == reflect::Op::kConst) {
    items.resize(static_cast<std::size_t>(field.count.steps[0].value), Tree::of_integer(0));
  }
  return Tree::of_array(std::move(items));
}

std::size_t Choices::take(std::size_t count) {
  if (used_ == all_.size()) all_.push_back({0, count});
  return all_[used_++].answer;
}

bool Choices::next() {
  all_.resize(used_);
  used_ = 0;
  while (!all_.empty()) {
    if (++all_.back().answer < all_.back().count) return true;
    all_.pop_back();
  }
  return false;
}

/// Adds the fields of `type` that `tree` lacks: the least value that is allowed, empty lists and
/// bytes. Leaves out those that the encoder fills in.
void fill(const Type& type, Tree& tree, Choices& choices) {
  tree.kind = Tree::Kind::kObject;
  for (int i = 0; i < type.field_count; ++i) {
    const Field& f = type.fields[i];
    if (f.condition.count) continue;
    Tree* given = find(tree, f.name);
    if (!given && reflect::holds_characters(f)) given = find(tree, exact_bytes_of(f.name));
    const bool structure = f.kind == reflect::Kind::kStruct;
    if (given && structure && f.repeat == reflect::Repeat::kOnce) {
      if (given->is(Tree::Kind::kObject)) fill_structure(f, *given, choices);
    } else if (given && structure) {
      for (Tree& item : given->items) fill_structure(f, item, choices);
    } else if (given || fill_body(type, f, tree, choices)) {
      continue;
    } else if (f.repeat != reflect::Repeat::kOnce) {
      tree.set(f.name, elements(f));
    } else if (structure) {
      Tree inner = Tree::of_object();
      fill_structure(f, inner, choices);
      tree.set(f.name, std::move(inner));
    } else if (f.kind == reflect::Kind::kBytes) {
      tree.set(f.name, Tree::of_string(""));
    } else {
      const Domain domain = Domain::of(f, type);
      if (domain.derived || domain.implied >= 0) continue;
      tree.set(f.name, Tree::of_integer(std::max<std::int64_t>(domain.min, 0)));
    }
  }
}

/// Moves bytes given in place of a body, which is a structure, to the opaque field below it.
void give_opaque(const Type& type, Tree& tree) {
  for (int i = 0; i < type.interpretation_count; ++i) {
    const reflect::Interpretation& one = type.interpretations[i];
    Tree* body = find(tree, one.field.name);
    if (!body || !body->is(Tree::Kind::kString)) continue;
    for (std::string& key : tree.keys) {
      if (key == one.field.name) key = type.fields[one.overlays].name;
    }
  }
  for (int i = 0; i < type.field_count; ++i) {
    const Field& f = type.fields[i];
    if (f.kind != reflect::Kind::kStruct || f.repeat != reflect::Repeat::kOnce) continue;
    Tree* inner = find(tree, f.name);
    if (!inner || !inner->is(Tree::Kind::kObject)) continue;
    for (const Type* inner_type : types_of(f)) give_opaque(*inner_type, *inner);
  }
}

constexpr int kAttemptsMax = 256;
constexpr std::size_t kIndexMax = 128;
constexpr std::size_t kPayloadMax = 114;

std::string hex_of(std::string_view bytes) {
  std::string text;
  put_hex(bytes, text);
  return text;
}

Tree tree_of_real(const std::string& text) {
  if (text == "nan") return Tree::of_string("NaN");
  if (text == "inf") return Tree::of_string("Infinity");
  if (text == "-inf") return Tree::of_string("-Infinity");
  return Tree::of_real(text);
}

/// Builds the tree of values for the codec's encoder.
class Builder {
 public:
  Builder(const Message& message, const Shape& shape, const Bindings& bindings, bool any)
      : message_(message), shape_(shape), bindings_(bindings), any_(any) {}

  Tree build() {
    Tree root = Tree::of_object();
    for (const FieldValue& field : with_paths(message_, shape_)) {
      const Shape::Alternatives* slots = shape_.find(field.path);
      const std::optional<Value> value = value_of(field, (*slots)[0]);
      if (!value) continue;
      const bool exact = (*slots)[0].domain.characters && value->is(Value::Kind::kBytes);
      put(root, exact ? exact_bytes_of(field.path) : field.path,
          tree_of(*value, *slots, field.place), field.place);
    }
    return root;
  }

 private:
  std::optional<Value> value_of(const FieldValue& field, const Slot& slot) const {
    const Value& value = field.value;
    if (!any_) return substituted(value, bindings_, field.place);
    const bool open_ended = value.is(Value::Kind::kAny) || value.is(Value::Kind::kVariable) ||
                            value.is(Value::Kind::kRange);
    if (open_ended && slot.kind != Slot::Kind::kLeaf && slot.kind != Slot::Kind::kAddress) {
      return std::nullopt;
    }
    return sample(value, slot);
  }

  // Returns some value that the pattern allows.
  static Value sample(const Value& value, const Slot& slot) {
    const bool range = value.is(Value::Kind::kRange);
    if (range && value.text.empty()) return Value::of(value.number);
    if (!range && !value.is(Value::Kind::kAny) && !value.is(Value::Kind::kVariable)) {
      Value copy = value;
      Slot item{.domain = slot.kind == Slot::Kind::kList ? slot.domain : Domain::devid()};
      for (Value& one : copy.items) one = sample(one, item);
      return copy;
    }
    if (slot.kind == Slot::Kind::kAddress) return Value::address(1, 1);
    if (slot.domain.kind == Domain::Kind::kBytes) return Value::quoted("");
    return Value::of(std::max(slot.domain.implied, slot.domain.min));
  }

  static Tree tree_of(const Value& value, const Shape::Alternatives& slots, Place place) {
    switch (value.kind) {
      case Value::Kind::kText:
        if (slots[0].domain.characters) return Tree::of_string(text_in(value, place));
        [[fallthrough]];
      case Value::Kind::kBytes: return Tree::of_string(hex_of(bytes_in(value, place)));
      case Value::Kind::kAddress: return address(value, place);
      case Value::Kind::kList: {
        std::vector<Tree> items;
        for (const Value& item : value.items) items.push_back(tree_of(item, slots, place));
        return Tree::of_array(std::move(items));
      }
      case Value::Kind::kReal:
        if (!value.negated) return tree_of_real(value.text);
        return tree_of_real(Value::real(1.0f).text == value.text ? "2.0" : "1.0");
      case Value::Kind::kNames:
        if (!value.negated) return names(value, slots, place);
        [[fallthrough]];
      default: return number(value, slots, place);
    }
  }

  static std::string text_in(const Value& value, Place place) {
    return value.negated && value.text.empty() ? "!" : bytes_in(value, place);
  }

  static Tree number(const Value& value, const Shape::Alternatives& slots, Place place) {
    const Slot* best = &slots[0];
    for (const Slot& slot : slots) {
      const bool named = value.is(Value::Kind::kNames) && slot.domain.number_of(value.text);
      if (named) best = &slot;
    }
    const Domain& domain = best->domain;
    if (domain.kind == Domain::Kind::kReal && !value.negated) return Tree::of_integer(value.number);
    if (domain.kind == Domain::Kind::kReal) {
      return tree_of_real(domain.show(number_in(domain, value, place)).text);
    }
    if (!value.negated && slots.size() > 1) return Tree::of_integer(value.number);
    return Tree::of_integer(number_in(domain, value, place));
  }

  // The enumeration may depend on other fields, so the encoder looks the name up.
  static Tree names(const Value& value, const Shape::Alternatives& slots, Place place) {
    bool known = false;
    for (const Slot& slot : slots) {
      if (!slot.domain.number_of(value.text)) continue;
      known = true;
      if (!slot.domain.mask) continue;
      std::vector<Tree> bits;
      std::string_view rest = value.text;
      while (true) {
        const std::size_t bar = rest.find('|');
        bits.push_back(Tree::of_string(rest.substr(0, bar)));
        if (bar == std::string_view::npos) return Tree::of_array(std::move(bits));
        rest.remove_prefix(bar + 1);
      }
    }
    if (!known) number_in(slots[0].domain, value, place);
    return Tree::of_string(value.text == "all" ? "broadcast" : value.text);
  }

  static Tree address(const Value& value, Place place) {
    const std::int64_t pid = number_in(Domain::pid(), value.items[0], place);
    std::int64_t devid = number_in(Domain::devid(), value.items[1], place);
    if (value.negated) devid = devid < 0xFFFF ? devid + 1 : devid - 1;
    Tree tree = Tree::of_object();
    tree.set("pid", Tree::of_integer(pid));
    tree.set("devid", Tree::of_integer(devid));
    return tree;
  }

  static Tree& member(Tree& object, std::string_view name) {
    for (std::size_t i = 0; i < object.keys.size(); ++i) {
      if (object.keys[i] == name) return object.items[i];
    }
    object.kind = Tree::Kind::kObject;
    return object.set(name, Tree{}).items.back();
  }

  static void put(Tree& root, std::string_view path, Tree value, Place place) {
    Tree* at = &root;
    while (true) {
      const std::size_t dot = path.find('.');
      std::string_view part = path.substr(0, dot);
      const std::size_t bracket = part.find('[');
      if (at->kind != Tree::Kind::kNull && at->kind != Tree::Kind::kObject) break;
      at = &member(*at, part.substr(0, bracket));
      if (bracket != std::string_view::npos) {
        std::int64_t index = 0;
        read_integer(part.substr(bracket + 1, part.size() - bracket - 2), index);
        if (at->kind != Tree::Kind::kNull && at->kind != Tree::Kind::kArray) break;
        at->kind = Tree::Kind::kArray;
        if (static_cast<std::size_t>(index) >= kIndexMax) {
          throw TraceError(place, "index " + std::to_string(index) + " is too large");
        }
        at->items.resize(std::max(at->items.size(), static_cast<std::size_t>(index) + 1));
        at = &at->items[static_cast<std::size_t>(index)];
      }
      if (dot == std::string_view::npos) {
        if (at->kind != Tree::Kind::kNull) break;
        *at = std::move(value);
        return;
      }
      path.remove_prefix(dot + 1);
    }
    throw TraceError(place, "'" + std::string(path) + "' is given twice");
  }

  const Message& message_;
  const Shape& shape_;
  const Bindings& bindings_;
  bool any_;
};

Place place_of(const Message& message, const std::string& path) {
  for (const FieldValue& field : message.fields) {
    const bool tail = path.size() > field.path.size() && path.ends_with(field.path) &&
                      path[path.size() - field.path.size() - 1] == '.';
    if (!field.path.empty() && (field.path == path || tail)) return field.place;
  }
  return message.place;
}

bool has_bodies(const reflect::Type& type) {
  return type.interpretation_count > 0 ||
         std::any_of(type.fields, type.fields + type.field_count,
                     [](const reflect::Field& f) { return f.choice != nullptr; });
}

[[noreturn]] void refuse(const Message& message, const reflect::EncodeError& error) {
  const std::string path = error.path().empty() ? "" : error.path() + ": ";
  throw TraceError(place_of(message, error.path()), message.name + ": " + path + error.problem());
}

// `...` also stands for the bytes behind the content that a given nbytes counts: a sink of release
// 1.0 forwards with nbytes 102, and what follows is left over from earlier frames.
std::size_t left_over_max(const Message& message) {
  const bool sized = std::any_of(message.fields.begin(), message.fields.end(),
                                 [](const FieldValue& field) { return field.path == "nbytes"; });
  return message.open && sized ? kPayloadMax : 0;
}

std::vector<std::uint8_t> encode_tree(const Message& message, const reflect::Type& type,
                                      Tree tree) {
  give_opaque(type, tree);
  std::vector<std::uint8_t> payload;
  std::optional<reflect::EncodeError> first;
  const std::vector<std::uint8_t> left_over(left_over_max(message), 0xA5);
  // Returns how many bytes the content lacks of those that nbytes counts: 0 if it is whole.
  const auto missing_bytes = [&](const Tree& tried, std::size_t stale) -> std::int64_t {
    payload.clear();
    try {
      reflect::encode(type, tried, Bytes(left_over.data(), stale),
                      stale > 0 ? reflect::Tail::kFault : reflect::Tail::kStale, payload);
      return 0;
    } catch (const reflect::EncodeError& error) {
      if (!first) first = error;
      return error.missing_bytes() > 0 ? error.missing_bytes() : -1;
    }
  };
  for (const bool padded : {false, true}) {
    if (padded && left_over.empty()) break;
    Choices choices;
    for (int attempt = 0; attempt < kAttemptsMax; ++attempt) {
      Tree tried = tree;
      if (message.open) fill(type, tried, choices);
      const std::int64_t missing = missing_bytes(tried, 0);
      if (missing == 0) return payload;
      const auto stale = static_cast<std::size_t>(missing);
      if (padded && stale <= left_over.size() && missing_bytes(tried, stale) == 0) return payload;
      if (!choices.next()) break;
    }
  }
  refuse(message, *first);
}

AmFrame encode_message(const Message& message, const Bindings& bindings, bool any) {
  const Shape* shape = Schema::get().find(message.name);
  if (!shape || (!shape->type && message.name != kFrameName)) {
    throw TraceError(message.place, "'" + message.name + "' is not a message of a frame");
  }
  if (message.form != Message::Form::kFields) {
    throw TraceError(message.place, "'" + message.name + "' needs its fields");
  }
  AmFrame frame;
  if (!shape->type) {
    const Concrete given = concrete(message, bindings);
    frame.type = static_cast<std::uint8_t>(given.leaves[0].number);
    frame.payload.assign(given.leaves[1].bytes.begin(), given.leaves[1].bytes.end());
    const Leaf* const size = given.leaf("size");
    if (size && size->number != static_cast<std::int64_t>(frame.payload.size())) {
      throw TraceError(message.place, "the payload has " + std::to_string(frame.payload.size()) +
                                          " bytes, not " + std::to_string(size->number));
    }
  } else {
    frame.type = shape->am_type;
    frame.payload =
        encode_tree(message, *shape->type, Builder(message, *shape, bindings, any).build());
  }
  if (frame.payload.size() > kPayloadMax) {
    throw TraceError(message.place, message.name + " has " + std::to_string(frame.payload.size()) +
                                        " bytes, at most " + std::to_string(kPayloadMax));
  }
  return frame;
}

}  // namespace

AmFrame encode(const Message& message, const Bindings& bindings) {
  return encode_message(message, bindings, false);
}

void check_possible(const Message& message) {
  if (message.name == kFrameName) return;
  const Shape* shape = Schema::get().find(message.name);
  if (!shape || !shape->type) return;
  bool free = false;
  bool free_bytes = false;
  for (const FieldValue& field : with_paths(message, *shape)) {
    const Slot& slot = shape->find(field.path)->front();
    const Slot::Kind kind = slot.kind;
    const bool any = field.value.is(Value::Kind::kAny) || field.value.is(Value::Kind::kVariable) ||
                     field.value.negated;
    free = free || any;
    free_bytes = free_bytes || (any && slot.domain.kind == Domain::Kind::kBytes);
    // A wildcard for a whole part has no values to compare with the spec.
    if (any && kind != Slot::Kind::kLeaf && kind != Slot::Kind::kAddress) return;
  }
  try {
    encode_message(message, {}, true);
  } catch (const TraceError&) {
    // Free fields may decide which other fields exist, free bytes have any size.
    if (!free_bytes && (!free || !has_bodies(*shape->type))) throw;
  }
}

namespace {

std::uint16_t am_number(const Value& value, const Bindings& bindings, Place place) {
  const Value given = substituted(value, bindings, place);
  return static_cast<std::uint16_t>(number_in(Domain::devid(), given, place));
}

std::uint16_t destination(const Line& line, const Scope& scope) {
  const NodeHeader* node = scope.node(line.node);
  if (line.op != Op::kGiven || !node || is_among(protocol().broadcast, line.message.name)) {
    return kAmAll;
  }
  if (scope.link(line.link) == LinkKind::kPeis) return node->island.value_or(kAmAll);
  return node->id.value_or(kAmAll);
}

// Returns the possible sender: the node in the src field, else nodes of the other role.
std::uint16_t source(const Line& line, const Scope& scope, const AmFrame& frame) {
  const LinkKind link = scope.link(line.link).value_or(LinkKind::kRadio);
  if (line.op != Op::kGiven) {
    const NodeHeader* node = scope.node(line.node);
    if (node && node->id) return *node->id;
  }
  const Concrete seen = decode(frame, link);
  const auto src = seen.pair("src");
  if (link == LinkKind::kPeis && src) return src->first;
  if (link != LinkKind::kRadio) return 0;
  if (src) {
    const auto known = [&](const NodeHeader& one) { return one.id == src->second; };
    if (std::any_of(scope.nodes.begin(), scope.nodes.end(), known)) return src->second;
  }
  // Sinks hear motes; a mote's other frames come from its sink. Of other protocols nothing is
  // known.
  const NodeHeader* hears = line.op == Op::kGiven ? scope.node(line.node) : nullptr;
  std::optional<std::uint16_t> found;
  for (const NodeHeader& one : scope.nodes) {
    const bool fits = !hears || !protocol().has_machine ||
                      (hears->role == Role::kSink) == (one.role == Role::kMote);
    if (!fits || !one.id || one.name == line.node) continue;
    if (found && found != one.id) {
      throw TraceError(line.place,
                       "several nodes can have sent this: am=SOURCE->DESTINATION says who");
    }
    found = one.id;
  }
  if (found) return *found;
  throw TraceError(line.place, "no node can have sent this: am=SOURCE->DESTINATION says who");
}

}  // namespace

AmFrame frame_of(const Line& line, const Scope& scope, const Bindings& bindings) {
  AmFrame frame;
  if (line.bytes) {
    if (parse_packet(*line.bytes, frame)) return frame;
    if (line.message.name != "*") {
      throw TraceError(line.place, "the bytes are no packet of an active message");
    }
    frame.packet.assign(line.bytes->begin(), line.bytes->end());
    return frame;
  }
  frame = encode(line.message, bindings);
  const bool serial = scope.link(line.link) == LinkKind::kSerial;
  if (serial && is_among(protocol().whole_on_serial, line.message.name)) {
    frame.payload.resize(kPayloadMax);
  }
  frame.src =
      line.am ? am_number(line.am->source, bindings, line.place) : source(line, scope, frame);
  frame.dest = line.am ? am_number(line.am->dest, bindings, line.place) : destination(line, scope);
  return frame;
}

}  // namespace rubric::trace
