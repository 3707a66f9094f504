#include "conformance/trace/schema.h"

#include <algorithm>
#include <cstring>

#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/decode.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/registry.h"
#include "codec/reflect/text_field.h"

namespace rubric::trace {
namespace {

using reflect::Field;
using reflect::Type;

bool reads(const reflect::Expr& expr, int index, std::int32_t offset) {
  for (int i = 0; i < expr.count; ++i) {
    const reflect::ExprStep& step = expr.steps[i];
    const bool load = step.op >= reflect::Op::kLoadU8 && step.op <= reflect::Op::kLoadLe32;
    const bool here = step.from == 0 ? step.value == offset : step.from == index + 1;
    if (load && here) return true;
  }
  return false;
}

bool measures(const Field& field, const Type& owner) {
  const auto index = static_cast<int>(&field - owner.fields);
  for (int i = 0; i < owner.field_count; ++i) {
    const Field& other = owner.fields[i];
    if (reads(other.size, index, field.fixed_offset) ||
        reads(other.count, index, field.fixed_offset)) {
      return true;
    }
  }
  return false;
}

bool is_address(const Type& type) {
  return type.field_count == 2 && std::strcmp(type.fields[0].name, "pid") == 0 &&
         std::strcmp(type.fields[1].name, "devid") == 0;
}

/// Collects the paths of a type and of all types that its bytes may have.
class Walk {
 public:
  explicit Walk(Shape& shape) : shape_(shape) {}

  void type(const Type& one) {
    for (int i = 0; i < one.field_count; ++i) field(one.fields[i], one);
    for (int i = 0; i < one.interpretation_count; ++i) field(one.interpretations[i].field, one);
  }

  void app(const AppMessage& message) {
    for (const AppField& one : message.fields) {
      const std::size_t size = push(one.name);
      if (one.kind == AppKind::kAddress) {
        add({Slot::Kind::kAddress, {}});
        leaf("pid", Domain::pid());
        leaf("devid", Domain::devid());
      } else if (one.kind == AppKind::kChannel) {
        add({Slot::Kind::kChannel, {}});
        leaf("src", Domain::devid());
        leaf("dest", Domain::devid());
      } else {
        add({Slot::Kind::kLeaf, Domain::of(one)});
      }
      path_.resize(size);
    }
  }

 private:
  std::size_t push(std::string_view name) {
    const std::size_t size = path_.size();
    if (size) path_ += '.';
    path_ += name;
    return size;
  }

  void leaf(std::string_view name, const Domain& domain) {
    const std::size_t size = push(name);
    add({Slot::Kind::kLeaf, domain});
    path_.resize(size);
  }

  void add(const Slot& slot) {
    Shape::Alternatives& all = shape_.slots[path_];
    if (std::find(all.begin(), all.end(), slot) == all.end()) all.push_back(slot);
    for (std::size_t dot = path_.find('.'); dot != std::string::npos;
         dot = path_.find('.', dot + 1)) {
      std::vector<std::string>& whole = shape_.tails[path_.substr(dot + 1)];
      if (std::find(whole.begin(), whole.end(), path_) == whole.end()) whole.push_back(path_);
    }
  }

  void field(const Field& f, const Type& owner) {
    const std::size_t size = push(f.name);
    if (f.kind != reflect::Kind::kStruct) {
      const Domain domain = Domain::of(f, owner);
      if (f.repeat == reflect::Repeat::kOnce) {
        add({Slot::Kind::kLeaf, domain});
      } else {
        add({Slot::Kind::kList, domain});
        path_ += "[]";
        add({Slot::Kind::kLeaf, domain});
      }
    } else if (f.repeat != reflect::Repeat::kOnce) {
      path_ += "[]";
      structure(f);
    } else {
      structure(f);
    }
    path_.resize(size);
  }

  void structure(const Field& f) {
    const bool address = f.type && is_address(*f.type);
    add({address ? Slot::Kind::kAddress : Slot::Kind::kStruct, {}});
    if (f.type) type(*f.type);
    if (!f.choice) return;
    for (int i = 0; i < f.choice->count; ++i) type(*f.choice->cases[i].type);
    if (f.choice->otherwise) type(*f.choice->otherwise);
  }

  Shape& shape_;
  std::string path_;
};

}  // namespace

Domain Domain::of(const Field& field, const Type& owner) {
  Domain domain;
  switch (field.kind) {
    case reflect::Kind::kFloat: domain.kind = Kind::kReal; break;
    case reflect::Kind::kBytes:
      if (reflect::holds_characters(field)) domain.characters = &field;
      [[fallthrough]];
    case reflect::Kind::kStruct: domain.kind = Kind::kBytes; break;
    default:
      domain.min = static_cast<std::int64_t>(field.limits().min);
      domain.max = static_cast<std::int64_t>(field.limits().max);
  }
  // The encoder fills no bits in.
  domain.derived = field.kind != reflect::Kind::kBits && measures(field, owner);
  domain.implied = field.expect;
  if (field.valid.kind == reflect::ValidKind::kOneOf && field.valid.one_of_count == 1) {
    domain.implied = field.valid.one_of[0];
  }
  domain.names = field.enumeration;
  domain.mask = field.mask;
  return domain;
}

Domain Domain::of(const AppField& field) {
  Domain domain;
  if (field.kind == AppKind::kReal) domain.kind = Kind::kReal;
  if (field.kind == AppKind::kBytes) domain.kind = Kind::kBytes;
  domain.max = field.max;
  domain.derived = field.derived;
  domain.names = field.names;
  domain.mask = field.mask;
  return domain;
}

Domain Domain::pid() { return {.max = 0xFFFF, .names = &rubicon::tables::enums::kPid}; }

Domain Domain::devid() {
  Domain domain = pid();
  domain.names = &rubicon::tables::enums::kDevid;
  return domain;
}

std::optional<std::int64_t> Domain::number_of(std::string_view text) const {
  std::int64_t number = 0;
  if (names) {
    if (text == "all") text = "broadcast";
    if (reflect::enum_value(*names, text, number)) return number;
  }
  if (!mask) return std::nullopt;
  while (true) {
    const std::size_t bar = text.find('|');
    const int bit = reflect::mask_bit(*mask, text.substr(0, bar));
    if (bit < 0) return std::nullopt;
    number |= std::int64_t{1} << bit;
    if (bar == std::string_view::npos) return number;
    text.remove_prefix(bar + 1);
  }
}

Value Domain::show(std::int64_t number) const {
  if (kind == Kind::kReal) return Value::real(float_of_bits(static_cast<std::uint32_t>(number)));
  if (names) {
    const char* name = reflect::enum_name(*names, number);
    if (name) return Value::names(std::strcmp(name, "broadcast") == 0 ? "all" : name);
  }
  if (!mask || number == 0) return Value::of(number);
  std::string text;
  for (int bit = 0; bit < mask->width_bits; ++bit) {
    if (!(number >> bit & 1)) continue;
    const char* name = mask->bit_names[bit];
    text += (text.empty() ? "" : "|") + (name ? std::string(name) : "bit" + std::to_string(bit));
  }
  return Value::names(text);
}

std::string Domain::expectation() const {
  if (kind == Kind::kReal) return "a number";
  if (kind == Kind::kBytes) return "bytes (x0a0b) or text in quotes";
  std::string text = "a number from " + std::to_string(min) + " to " + std::to_string(max);
  const auto add = [&](const char* name, bool& first) {
    text += (first ? " or of " : ", ") + std::string(name);
    first = false;
  };
  bool first = true;
  constexpr int kShown = 12;
  for (int i = 0; names && i < names->count && i < kShown; ++i) add(names->entries[i].name, first);
  if (names && names->count > kShown) text += ", ...";
  for (int i = 0; mask && i < mask->width_bits; ++i) {
    if (mask->bit_names[i]) add(mask->bit_names[i], first);
  }
  return text;
}

bool Shape::travels(LinkKind link) const {
  switch (link) {
    case LinkKind::kRadio: return radio;
    case LinkKind::kSerial: return serial;
    case LinkKind::kPeis: return peis;
    case LinkKind::kApp:
      return app && (app->what == AppWhat::kCall || app->what == AppWhat::kEvent ||
                     app->what == AppWhat::kState);
    case LinkKind::kPower: return app && app->what == AppWhat::kPower;
    case LinkKind::kAny: return true;
  }
  return false;
}

std::string Shape::resolve(std::string_view path, std::vector<std::string>* candidates) const {
  const bool indexed = path.find('[') != std::string_view::npos;
  const std::string plain = indexed ? without_indexes(path) : std::string(path);
  if (slots.contains(plain)) return std::string(path);
  const auto found = tails.find(plain);
  if (found == tails.end()) return {};
  if (found->second.size() > 1) {
    if (candidates) *candidates = found->second;
    return {};
  }
  // Indexes before the tail are unknown.
  const std::string front = found->second[0].substr(0, found->second[0].size() - plain.size());
  if (front.find('[') != std::string::npos) {
    if (candidates) *candidates = found->second;
    return {};
  }
  return front + std::string(path);
}

const Shape::Alternatives* Shape::find(std::string_view whole_path) const {
  const auto found = slots.find(without_indexes(whole_path));
  return found == slots.end() ? nullptr : &found->second;
}

std::string without_indexes(std::string_view path) {
  std::string plain;
  bool inside = false;
  for (const char c : path) {
    if (c == ']') inside = false;
    if (!inside) plain += c;
    if (c == '[') inside = true;
  }
  return plain;
}

const Schema& Schema::get() {
  static const Schema schema;
  return schema;
}

Schema::Schema() {
  for (const AppMessage& message : protocol().messages) {
    Shape& shape = shapes_[message.name];
    shape.name = message.name;
    shape.app = &message;
    shape.radio = message.what == AppWhat::kState || message.what == AppWhat::kRadio ||
                  message.what == AppWhat::kFrame;
    shape.serial = shape.peis = shape.radio && message.what != AppWhat::kRadio;
    Walk(shape).app(message);
  }
  add_carrier(*protocol().wire, "radio_i", &Shape::radio);
  add_carrier(*protocol().wire, "serial", &Shape::serial);
}

void Schema::add_carrier(const reflect::Protocol& wire, const char* carrier, bool Shape::*travels) {
  const Type* type = reflect::find_carrier(wire, carrier);
  if (!type || type->field_count == 0) return;
  const reflect::Switch* choice = type->fields[type->field_count - 1].choice;
  if (!choice) return;
  (travels == &Shape::radio ? radio_ : serial_) = choice;
  for (int i = 0; i < choice->count; ++i) {
    const Type* message = choice->cases[i].type;
    Shape& shape = shapes_[message->name];
    shape.*travels = true;
    if (shape.type) continue;
    shape.name = message->name;
    shape.type = message;
    shape.am_type = static_cast<std::uint8_t>(choice->cases[i].key);
    shape.peis = is_among(protocol().on_peis, shape.name);
    Walk(shape).type(*message);
  }
}

const Shape* Schema::find(std::string_view name) const {
  const auto found = shapes_.find(std::string(name));
  return found == shapes_.end() ? nullptr : &found->second;
}

const Type* Schema::payload_type(LinkKind link, std::uint8_t am_type) const {
  const reflect::Switch* choice = link == LinkKind::kSerial ? serial_ : radio_;
  const Type* type = choice ? reflect::choose(*choice, am_type) : nullptr;
  if (type && link == LinkKind::kPeis && !is_among(protocol().on_peis, type->name)) return nullptr;
  return type;
}

}  // namespace rubric::trace
