#include "conformance/trace/concrete.h"

#include <algorithm>
#include <cstring>

#include "codec/reflect/decode.h"
#include "codec/reflect/text_field.h"
#include "conformance/trace/match.h"

namespace rubric::trace {
namespace {

using reflect::Decoded;
using reflect::Node;
using reflect::NodeKind;

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Bytes that read as text are shown as text.
Value show_bytes(const std::string& bytes) {
  const bool text = bytes.size() > 1 && std::all_of(bytes.begin(), bytes.end(),
                                                    [](char c) { return c >= ' ' && c < 0x7F; });
  return text ? Value::quoted(bytes) : Value::bytes(bytes);
}

Bytes bytes_in_text(const std::string& text) {
  return Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

std::optional<std::string> sound_text(const reflect::Field& field, const std::string& bytes) {
  const Bytes all = bytes_in_text(bytes);
  const Bytes content = reflect::text_content(field, all);
  if (reflect::sound_text(field, content) != content.size()) return std::nullopt;
  return reflect::shown_text(field, all);
}

/// Makes leaves and parts of the nodes of a decoded message.
class Flatten {
 public:
  Flatten(const Decoded& decoded, Concrete& out) : decoded_(decoded), out_(out) {}

  void run() { children(0); }

 private:
  void children(std::size_t parent) {
    for (std::size_t i = parent + 1; i < decoded_[parent].end; i = decoded_[i].end) {
      const std::size_t size = path_.size();
      const Node& node = decoded_[i];
      if (size) path_ += '.';
      path_ += node.field->name;
      one(i, *decoded_[parent].type);
      path_.resize(size);
    }
  }

  void one(std::size_t i, const reflect::Type& owner) {
    const Node& node = decoded_[i];
    switch (node.kind) {
      case NodeKind::kNumber:
        leaf(Domain::of(*node.field, owner)).number = node.value;
        if (!inside_) show(out_.leaves.back().show());
        return;
      case NodeKind::kBytes: return opaque(node, owner);
      case NodeKind::kNumberArray: return numbers(node, owner);
      case NodeKind::kStruct: return structure(i, owner);
      case NodeKind::kStructArray: return structures(i);
    }
  }

  Leaf& leaf(const Domain& domain) {
    Leaf& added = out_.leaves.emplace_back();
    added.path = path_;
    added.domain = domain;
    return added;
  }

  void show(Value value) { out_.message.with(path_, std::move(value)); }

  std::string bytes_of(const Node& node) const {
    return std::string(text_of(decoded_.bytes.sub(node.offset, node.size)));
  }

  void opaque(const Node& node, const reflect::Type& owner) {
    const Domain domain = Domain::of(*node.field, owner);
    Leaf& added = leaf(domain);
    added.bytes = bytes_of(node);
    if (domain.characters) added.text = sound_text(*node.field, added.bytes);
    for (int k = 0; k < owner.interpretation_count; ++k) {
      const reflect::Interpretation& one = owner.interpretations[k];
      if (&owner.fields[one.overlays] == node.field) added.alias = sibling(one.field.name);
    }
    show(added.show());
  }

  // Returns the present path with another last name.
  std::string sibling(std::string_view name) const {
    const std::size_t dot = path_.rfind('.');
    return (dot == std::string::npos ? "" : path_.substr(0, dot + 1)) + std::string(name);
  }

  void numbers(const Node& node, const reflect::Type& owner) {
    const std::size_t index = begin(Slot::Kind::kList);
    const Domain domain = Domain::of(*node.field, owner);
    const std::string path = path_;
    std::vector<Value> shown;
    for (std::uint32_t k = 0; k < node.count; ++k) {
      path_ = path + '[' + std::to_string(k) + ']';
      Leaf& added = leaf(domain);
      added.number = reflect::load_number(
          *node.field, decoded_.bytes.data() + node.offset + k * node.field->width_bytes);
      shown.push_back(added.show());
    }
    path_ = path;
    out_.parts[index].end = out_.leaves.size();
    show(Value::list(std::move(shown)));
  }

  std::size_t begin(Slot::Kind kind) {
    Part& part = out_.parts.emplace_back();
    part.path = path_;
    part.kind = kind;
    part.first = out_.leaves.size();
    return out_.parts.size() - 1;
  }

  void structure(std::size_t i, const reflect::Type& owner) {
    const Node& node = decoded_[i];
    const bool address = node.type->field_count == 2 &&
                         std::strcmp(node.type->fields[0].name, "pid") == 0 &&
                         std::strcmp(node.type->fields[1].name, "devid") == 0;
    const std::size_t index = begin(address ? Slot::Kind::kAddress : Slot::Kind::kStruct);
    out_.parts[index].bytes = bytes_of(node);
    for (int k = 0; k < owner.interpretation_count; ++k) {
      const reflect::Interpretation& one = owner.interpretations[k];
      if (&one.field == node.field) {
        out_.parts[index].alias = sibling(owner.fields[one.overlays].name);
      }
    }
    const bool before = std::exchange(inside_, inside_ || address);
    children(i);
    inside_ = before;
    Part& part = out_.parts[index];
    part.end = out_.leaves.size();
    if (!address || part.end - part.first != 2) return;
    show(Value::address(static_cast<std::uint16_t>(out_.leaves[part.first].number),
                        static_cast<std::uint16_t>(out_.leaves[part.first + 1].number)));
  }

  void structures(std::size_t i) {
    const std::string path = path_;
    std::size_t k = 0;
    for (std::size_t at = i + 1; at < decoded_[i].end; at = decoded_[at].end) {
      path_ = path + '[' + std::to_string(k++) + ']';
      children(at);
    }
    path_ = path;
  }

  const Decoded& decoded_;
  Concrete& out_;
  std::string path_;
  bool inside_ = false;  // Inside an address, which is shown as a whole.
};

// Frames are named by their payload; that a whole frame was understood is only of interest to
// `decode`.
bool decode_as(const reflect::Type& type, const AmFrame& frame, Concrete& out) {
  Decoded decoded;  // A thread's own would end the process where memory for its end is missing.
  const Bytes bytes(frame.payload.data(), frame.payload.size());
  decoded.clear(bytes);
  reflect::decode(type, bytes, reflect::Tail::kStale, true, decoded);
  if (decoded.error.fault != Fault::kNone || decoded.node_count() == 0) return false;
  out.name = type.name;
  out.message = Message::named(type.name);
  if (type.min_size == type.max_size && bytes.size() > type.max_size) {
    out.excess = bytes.size() - type.max_size;
    out.size_rule = type.requirement;
  }
  out.leaves.reserve(decoded.node_count());
  out.message.fields.reserve(decoded.node_count());
  Flatten(decoded, out).run();
  return true;
}

}  // namespace

const Value* Bindings::find(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? nullptr : &found->second;
}

void Bindings::set(std::string_view name, Value value) {
  values_.insert_or_assign(std::string(name), std::move(value));
}

Value Leaf::value() const {
  if (domain.characters) return show();
  if (domain.kind == Domain::Kind::kBytes) return Value::bytes(bytes);
  return domain.kind == Domain::Kind::kReal ? domain.show(number) : Value::of(number);
}

// Text that does not say all of its bytes, as those behind its terminator, is shown as bytes.
Value Leaf::show() const {
  if (domain.characters) {
    const bool says_all = text && reflect::says_all(*domain.characters, bytes_in_text(bytes));
    return says_all ? Value::quoted(*text) : Value::bytes(bytes);
  }
  return domain.kind == Domain::Kind::kBytes ? show_bytes(bytes) : domain.show(number);
}

const Leaf* Concrete::leaf(std::string_view path) const {
  for (const Leaf& one : leaves) {
    if (one.path == path || (!one.alias.empty() && one.alias == path)) return &one;
  }
  return nullptr;
}

const Part* Concrete::part(std::string_view path) const {
  for (const Part& one : parts) {
    if (one.path == path || (!one.alias.empty() && one.alias == path)) return &one;
  }
  return nullptr;
}

std::optional<std::int64_t> Concrete::number(std::string_view path) const {
  const Leaf* found = leaf(path);
  if (!found || found->domain.kind == Domain::Kind::kBytes) return std::nullopt;
  return found->number;
}

std::optional<std::pair<std::uint16_t, std::uint16_t>> Concrete::pair(std::string_view path) const {
  const Part* found = part(path);
  if (!found || found->end - found->first != 2 ||
      (found->kind != Slot::Kind::kAddress && found->kind != Slot::Kind::kChannel)) {
    return std::nullopt;
  }
  return std::pair(static_cast<std::uint16_t>(leaves[found->first].number),
                   static_cast<std::uint16_t>(leaves[found->first + 1].number));
}

Concrete decode(const AmFrame& frame, LinkKind link) {
  if (!frame.packet.empty()) return {.name = "*", .frame = frame};
  const reflect::Type* type = Schema::get().payload_type(link, frame.type);
  Concrete out;
  if (!type || !decode_as(*type, frame, out)) return decode_raw(frame);
  out.frame = frame;
  return out;
}

Concrete decode_raw(const AmFrame& frame) {
  const std::string payload(text_of({frame.payload.data(), frame.payload.size()}));
  const std::vector<AppField>& fields = Schema::get().find(kFrameName)->app->fields;
  Concrete out{.name = kFrameName, .frame = frame};
  Leaf type;
  type.path = "type";
  type.domain = Domain::of(fields[0]);
  type.number = frame.type;
  Leaf bytes{.path = "payload", .domain = Domain::of(fields[1]), .bytes = payload};
  out.message =
      Message::named(kFrameName).with("type", type.show()).with("payload", Value::bytes(payload));
  Leaf size;
  size.path = "size";
  size.domain = Domain::of(fields[2]);
  size.number = static_cast<std::int64_t>(frame.payload.size());
  out.leaves.push_back(std::move(type));
  out.leaves.push_back(std::move(bytes));
  out.leaves.push_back(std::move(size));
  return out;
}

namespace {

void put_leaf(const std::string& path, const Domain& domain, const Value& value, Place place,
              Concrete& out) {
  Leaf leaf{.path = path, .domain = domain};
  if (domain.kind == Domain::Kind::kBytes) {
    leaf.bytes = bytes_in(value, place);
  } else {
    leaf.number = number_in(domain, value, place);
  }
  out.leaves.push_back(std::move(leaf));
}

void put_pair(const AppField& field, const Value& value, Place place, Concrete& out) {
  const bool address = field.kind == AppKind::kAddress;
  const Value::Kind wanted = address ? Value::Kind::kAddress : Value::Kind::kChannel;
  const std::string& path = field.name;
  if (!value.is(wanted)) {
    throw TraceError(
        place, path + ": expected " + (address ? "an address, as 11:5" : "a channel, as 2->1"));
  }
  Part part{.path = path,
            .kind = address ? Slot::Kind::kAddress : Slot::Kind::kChannel,
            .first = out.leaves.size()};
  part.end = part.first + 2;
  out.parts.push_back(std::move(part));
  put_leaf(path + (address ? ".pid" : ".src"), address ? Domain::pid() : Domain::devid(),
           value.items[0], place, out);
  put_leaf(path + (address ? ".devid" : ".dest"), Domain::devid(), value.items[1], place, out);
  if (value.negated) {
    Leaf& last = out.leaves.back();
    last.number = last.number < last.domain.max ? last.number + 1 : last.number - 1;
  }
  const auto half = [&](std::size_t back) {
    return static_cast<std::uint16_t>(out.leaves[out.leaves.size() - back].number);
  };
  out.message.with(path, address ? Value::address(half(2), half(1))
                                 : Value::channel(std::uint32_t{half(2)} << 16 | half(1)));
}

}  // namespace

Concrete concrete(const Message& message, const Bindings& bindings) {
  const Shape* shape = Schema::get().find(message.name);
  if (!shape || !shape->app) {
    throw TraceError(message.place, "'" + message.name + "' is not a message of an application");
  }
  if (message.form != Message::Form::kFields && !shape->app->fields.empty()) {
    throw TraceError(message.place, "'" + message.name + "' needs its fields");
  }
  Concrete out{.name = message.name};
  if (message.form == Message::Form::kFields) out.message = Message::named(message.name);
  out.message.name = message.name;
  const std::vector<FieldValue> fields = with_paths(message, *shape);
  for (const AppField& field : shape->app->fields) {
    const auto given = std::find_if(fields.begin(), fields.end(),
                                    [&](const FieldValue& one) { return one.path == field.name; });
    if (given == fields.end() && field.derived) continue;
    if (given == fields.end() && !message.open) {
      throw TraceError(message.place,
                       "field " + field.name + " of " + message.name + " is missing");
    }
    const bool pair = field.kind == AppKind::kAddress || field.kind == AppKind::kChannel;
    const Place place = given == fields.end() ? message.place : given->place;
    Value value = Value::of(0);
    if (given != fields.end()) {
      value = substituted(given->value, bindings, place);
    } else if (pair) {
      value = field.kind == AppKind::kAddress ? Value::address(0, 0) : Value::channel(0);
    } else if (field.kind == AppKind::kBytes) {
      value = Value::bytes("");
    }
    if (pair) {
      put_pair(field, value, place, out);
    } else {
      put_leaf(field.name, Domain::of(field), value, place, out);
      out.message.with(field.name, out.leaves.back().show());
    }
  }
  return out;
}

Line frame_line(std::int64_t ticks, std::string_view node, Op op, std::string_view link,
                LinkKind kind, const AmFrame& frame) {
  Concrete seen = decode(frame, kind);
  const auto am = [](std::uint16_t id) {
    return id == kAmAll ? Value::names("all") : Value::of(id);
  };
  const std::vector<std::uint8_t> packet = packet_of(frame);
  Line line{
      .time = Time::at(ticks), .node = std::string(node), .op = op, .link = std::string(link)};
  if (frame.packet.empty()) line.am = AmAddresses{am(frame.src), am(frame.dest)};
  line.message = std::move(seen.message);
  line.bytes = std::string(text_of({packet.data(), packet.size()}));
  return line;
}

Line fault_line(std::int64_t ticks, Op op, std::string_view link, LinkKind kind,
                const AmFrame& frame) {
  return frame_line(ticks, {}, op, link, kind, frame);
}

Line app_line(std::int64_t ticks, std::string_view node, Op op, std::string_view link,
              Message message) {
  Line line;
  line.time = Time::at(ticks);
  line.node = node;
  line.op = op;
  line.link = link;
  line.message = std::move(message);
  return line;
}

}  // namespace rubric::trace
