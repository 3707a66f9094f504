#include "conformance/trace/trace.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <unordered_map>

#include "codec/reflect/am_frames.h"
#include "codec/reflect/requirements.h"
#include "codec/runtime/bytes.h"
#include "conformance/trace/protocol.h"

namespace rubric::trace {
namespace {

// Returns reserved numbers by their names in address shorthand.
Value pid_value(std::uint16_t pid) {
  if (pid == 0xFFFF) return Value::names("all");
  if (pid == 0xFFFE) return Value::names("local");
  if (pid == 0xFFFD) return Value::names("proxy");
  return Value::of(pid);
}
Value devid_value(std::uint16_t devid) {
  if (devid == 0xFFFF) return Value::names("all");
  if (devid == 0xFFFE) return Value::names("local");
  if (devid == 0xFFFD) return Value::names("null");
  return Value::of(devid);
}

Value of_kind(Value::Kind kind, std::string_view text) {
  return {.kind = kind, .text = std::string(text)};
}

Value pair(Value::Kind kind, Value first, Value second) {
  return {.kind = kind, .items = {std::move(first), std::move(second)}};
}

}  // namespace

Value Value::of(std::int64_t number) { return {.kind = Kind::kNumber, .number = number}; }

Value Value::range(std::int64_t min, std::int64_t max) {
  return {.kind = Kind::kRange, .number = min, .max = max};
}

Value Value::range(std::string_view variable, std::int64_t min, std::int64_t max) {
  Value value = range(min, max);
  value.text = variable;
  return value;
}

Value Value::real(float number) {
  if (std::isnan(number)) return of_kind(Kind::kReal, "nan");
  if (std::isinf(number)) return of_kind(Kind::kReal, number < 0 ? "-inf" : "inf");
  char text[32];
  const auto result = std::to_chars(std::begin(text), std::end(text), number);
  std::string shown(std::begin(text), result.ptr);
  if (shown.find_first_of(".e") == std::string::npos) shown += ".0";
  return of_kind(Kind::kReal, shown);
}

Value Value::names(std::string_view names) { return of_kind(Kind::kNames, names); }
Value Value::bytes(std::string_view raw) { return of_kind(Kind::kBytes, raw); }
Value Value::quoted(std::string_view raw) { return of_kind(Kind::kText, raw); }
Value Value::variable(std::string_view name) { return of_kind(Kind::kVariable, name); }

Value Value::address(Value pid, Value devid) {
  return pair(Kind::kAddress, std::move(pid), std::move(devid));
}
Value Value::channel(Value source, Value destination) {
  return pair(Kind::kChannel, std::move(source), std::move(destination));
}
Value Value::address(std::uint16_t pid, std::uint16_t devid) {
  return address(pid_value(pid), devid_value(devid));
}
Value Value::channel(std::uint32_t id) {
  return channel(devid_value(static_cast<std::uint16_t>(id >> 16)),
                 devid_value(static_cast<std::uint16_t>(id & 0xFFFF)));
}

Value Value::list(std::vector<Value> items) {
  return {.kind = Kind::kList, .items = std::move(items)};
}

Value Value::but(Value value) {
  value.negated = true;
  return value;
}

Message Message::named(std::string_view name) {
  return {.name = std::string(name), .form = Form::kFields};
}

Message& Message::with(std::string_view path, Value value) & {
  form = Form::kFields;
  fields.push_back({std::string(path), std::move(value), {}});
  return *this;
}
Message&& Message::with(std::string_view path, Value value) && {
  with(path, std::move(value));
  return std::move(*this);
}

const Value* Message::find(std::string_view path) const {
  for (const FieldValue& field : fields) {
    if (field.path == path) return &field.value;
  }
  return nullptr;
}

std::vector<std::uint8_t> packet_of(const AmFrame& frame) {
  if (!frame.packet.empty()) return frame.packet;
  return reflect::serial_packet(
      {.dest = frame.dest, .src = frame.src, .group = frame.group, .type = frame.type},
      Bytes(frame.payload.data(), frame.payload.size()));
}

bool parse_packet(std::string_view bytes, AmFrame& out) {
  const Bytes packet(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  if (packet.size() < reflect::kAmHeaderBytes) return false;
  using Am = tinyos::AmHeaderLayout;
  const std::uint8_t* const p = packet.data();
  const Bytes payload = packet.from(reflect::kAmHeaderBytes);
  if (Am::DispatchAt::load(p) != tinyos::Dispatch::kActiveMessage ||
      Am::LengthAt::load(p) != payload.size()) {
    return false;
  }
  out.dest = Am::DestAt::load(p);
  out.src = Am::SrcAt::load(p);
  out.group = Am::GroupAt::load(p);
  out.type = Am::TypeAt::load(p);
  out.payload.assign(payload.begin(), payload.end());
  out.packet.clear();
  return true;
}

std::string_view op_text(Op op) {
  switch (op) {
    case Op::kGiven: return "<";
    case Op::kEmits: return ">";
    case Op::kMustNot: return "!>";
    case Op::kMay: return "?>";
    case Op::kLost: return "lost";
    case Op::kDup: return "dup";
  }
  return {};
}

std::string_view role_text(Role role) { return role_info(role).name; }

const RoleInfo& role_info(Role role) { return protocol().roles.at(static_cast<std::size_t>(role)); }

std::optional<Role> find_role(std::string_view name) {
  const std::vector<RoleInfo>& roles = protocol().roles;
  const auto found = std::find_if(roles.begin(), roles.end(),
                                  [&](const RoleInfo& one) { return one.name == name; });
  if (found == roles.end()) return std::nullopt;
  return static_cast<Role>(found - roles.begin());
}

std::string_view tick_text(Tick tick) {
  switch (tick) {
    case Tick::kBinaryMs: return "binary_ms";
    case Tick::kMs: return "ms";
    case Tick::kUs: return "us";
  }
  return {};
}

std::string_view link_text(LinkKind kind) {
  switch (kind) {
    case LinkKind::kRadio: return "radio";
    case LinkKind::kSerial: return "serial";
    case LinkKind::kPeis: return "peis";
    case LinkKind::kApp: return "app";
    case LinkKind::kPower: return "power";
    case LinkKind::kAny: return "*";
  }
  return {};
}

std::uint32_t ticks_per_second(Tick tick) {
  return tick == Tick::kBinaryMs ? 1024 : tick == Tick::kMs ? 1000 : 1000000;
}

std::vector<const Line*> Case::lines() const& {
  std::vector<const Line*> found;
  for (const Item& item : items) {
    if (const auto* line = item.as<Line>()) found.push_back(line);
  }
  return found;
}

File File::begin(std::string_view profile, Tick tick) {
  File file;
  file.header({VersionHeader{}, {}, {}});
  if (!profile.empty()) file.header({ProfileHeader{std::string(profile)}, {}, {}});
  if (tick != Tick::kBinaryMs) file.header({TickHeader{tick}, {}, {}});
  return file;
}

File& File::node(NodeHeader node_header) { return header({std::move(node_header), {}, {}}); }

File& File::header(Header one) {
  head.emplace_back(std::move(one));
  return *this;
}

const Case* File::find(std::string_view case_name) const {
  for (const Case& one : cases) {
    if (one.name == case_name) return &one;
  }
  return nullptr;
}

namespace {

// Applies headers: a case's headers of nodes, or of links, replace all such headers of the file.
void apply(const std::vector<Item>& items, Scope& scope) {
  bool nodes = false;
  bool links = false;
  for (const Item& item : items) {
    const auto* header = item.as<Header>();
    if (!header) continue;
    if (const auto* profile = std::get_if<ProfileHeader>(&header->what)) {
      scope.profile = profile->name;
    } else if (const auto* tick = std::get_if<TickHeader>(&header->what)) {
      scope.tick = tick->tick;
    } else if (const auto* seed = std::get_if<SeedHeader>(&header->what)) {
      scope.seed = seed->seed;
    } else if (const auto* node = std::get_if<NodeHeader>(&header->what)) {
      if (!std::exchange(nodes, true)) scope.nodes.clear();
      scope.nodes.push_back(*node);
    } else if (const auto* link = std::get_if<LinkHeader>(&header->what)) {
      if (!std::exchange(links, true)) scope.links.clear();
      scope.links.push_back(*link);
    }
  }
}

}  // namespace

Scope scope_of(const File& file, const Case& one) {
  Scope scope;
  if (protocol().profiles.empty()) scope.profile.clear();
  apply(file.head, scope);
  apply(one.items, scope);
  return scope;
}

const NodeHeader* Scope::node(std::string_view name) const {
  for (const NodeHeader& one : nodes) {
    if (one.name == name) return &one;
  }
  return nullptr;
}

std::optional<LinkKind> Scope::link(std::string_view name) const {
  for (const LinkHeader& one : links) {
    if (one.name == name) return one.kind;
  }
  if (name == "*") return LinkKind::kAny;
  if (name == "app") return LinkKind::kApp;
  if (name == "power") return LinkKind::kPower;
  if (name == "peis") return LinkKind::kPeis;
  if (name.size() > 3 && name.starts_with("ser")) return LinkKind::kSerial;
  if (name.size() > 1 && name[0] == 'r') return LinkKind::kRadio;
  return std::nullopt;
}

std::string_view requirement_text(ReqId id) { return reflect::requirement(id).id; }

ReqId requirement_id(std::string_view text) {
  static const std::unordered_map<std::string_view, ReqId> known = [] {
    std::unordered_map<std::string_view, ReqId> all;
    for (const reflect::Requirement& one : reflect::requirements().subspan(1)) {
      all.emplace(one.id, one.number());
    }
    return all;
  }();
  const auto found = known.find(text);
  return found == known.end() ? ReqId::kNone : found->second;
}

}  // namespace rubric::trace
