#include "conformance/check/report/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "conformance/check/message.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/print.h"

namespace rubric::report {
namespace {

using check::kNobody;
using machine::Role;
using Kind = check::Observation::Kind;

trace::Concrete decoded(const check::Observation& seen) {
  const machine::Frame& frame = seen.frame;
  trace::AmFrame am{frame.dest, frame.src, 0, frame.type, {}};
  am.payload.assign(frame.payload.data(), frame.payload.data() + frame.payload.size());
  return trace::decode(am, frame.link == machine::Link::kRadio    ? trace::LinkKind::kRadio
                           : frame.link == machine::Link::kSerial ? trace::LinkKind::kSerial
                                                                  : trace::LinkKind::kPeis);
}

// Returns the last `parts` parts of a path.
std::string tail(const std::string& path, std::size_t parts) {
  std::size_t at = path.size();
  for (; parts > 0 && at != path.npos && at != 0; --parts) at = path.rfind('.', at - 1);
  return at == path.npos || parts > 0 ? path : path.substr(at + 1);
}

// Shortens paths to what tells them apart.
void shorten(trace::Message& message) {
  std::vector<std::string> paths;
  for (const trace::FieldValue& field : message.fields) paths.push_back(field.path);
  for (trace::FieldValue& field : message.fields) {
    for (std::size_t parts = 1; parts < 5; ++parts) {
      const std::string shorter = tail(field.path, parts);
      const auto same = [&](const std::string& path) { return tail(path, parts) == shorter; };
      if (std::count_if(paths.begin(), paths.end(), same) != 1) continue;
      field.path = shorter;
      break;
    }
  }
}

// Ends words that are too long to read, hex above all, in dots.
std::string without_long_words(const std::string& text) {
  constexpr std::size_t kLongest = 64;
  constexpr std::size_t kKept = 48;
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const bool is_long = end - at > kLongest;
    const bool closes = is_long && text[end - 1] == ')';
    out += is_long ? text.substr(at, kKept) + "..." : text.substr(at, end - at);
    if (closes) out += ')';
    if (end < text.size()) out += ' ';
    at = end + 1;
  }
  return out;
}

std::string value_of(const trace::Message& message, std::string_view path) {
  const trace::Value* value = message.find(path);
  if (!value) return {};
  if (value->is(trace::Value::Kind::kNames)) return value->text;
  return value->is(trace::Value::Kind::kNumber) ? std::to_string(value->number) : std::string();
}

std::string net_label(const trace::Message& message) {
  const std::string trans = value_of(message, "payload.trans_id");
  if (trans == "rubicon_ack") return "ack of " + value_of(message, "payload.body.seq_num");
  std::string app = value_of(message, "payload.app_id");
  if (app == "control_layer") {  // The layer's own messages have names of their own.
    for (const char* path : {"payload.body.type", "payload.body.msg_type"}) {
      if (const std::string name = value_of(message, path); !name.empty()) app = name;
    }
  }
  const std::string seq = value_of(message, "seq_num");
  return fmt::format("{} {}", app.empty() ? message.name : app, seq);
}

std::string short_name(const check::Device& device) {
  if (!device.known) return fmt::format("unknown {}", device.am);
  if (device.role == Role::kMote) return fmt::format("mote {}", device.am);
  const bool known = device.island != check::kNoIsland;
  if (device.role == Role::kBaseStation)
    return known ? fmt::format("base {}", device.island) : "base";
  return known ? fmt::format("sink {}", device.island) : fmt::format("sink #{}", device.am);
}

std::string address_text(std::uint16_t am) {
  return am == 0xFFFF ? std::string("all") : fmt::format("address {}", am);
}

}  // namespace

Scene::Scene(const check::Run& run, const check::Options& options)
    : run_(run), who_(check::identify(run, options)) {
  std::uint16_t first_island = check::kNoIsland;
  for (const check::Device& device : who_.devices) {
    names_.push_back(short_name(device));
    if (device.role == Role::kSink) sinks_.insert(device.am);
    const auto node = static_cast<std::uint16_t>(&device - who_.devices.data());
    of_am_[device.am].push_back(node);
    if (device.am != 0xFFFF) of_am_[0xFFFF].push_back(node);
    const bool motes = device.role == Role::kMote || device.island == check::kNoIsland;
    if (!motes && device.island < first_island) first_island = device.island;
  }
  // Columns from left to right: base station and sink of one island; further sinks before their
  // base stations.
  using Order = std::tuple<int, std::uint16_t, int, std::uint16_t, std::size_t>;
  std::vector<Order> order;
  for (std::size_t i = 0; i < who_.devices.size(); ++i) {
    const check::Device& device = who_.devices[i];
    const bool base = device.role == Role::kBaseStation;
    const bool left = device.role != Role::kMote && device.island == first_island;
    const int side = device.role == Role::kMote ? 1 : left ? 0 : 2;
    order.emplace_back(side, device.role == Role::kMote ? std::uint16_t{0} : device.island,
                       base == left ? 0 : 1, device.am, i);
  }
  std::sort(order.begin(), order.end());
  ranks_.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) ranks_[std::get<4>(order[i])] = i;
}

std::uint16_t Scene::node_named(const std::string& name) const {
  for (std::size_t i = 0; i < who_.devices.size(); ++i) {
    if (who_.devices[i].name == name) return static_cast<std::uint16_t>(i);
  }
  return kNobody;
}

void Scene::add_radio_receivers(std::size_t i, std::vector<std::uint16_t>& out) const {
  const machine::Frame& frame = run_.seen[i].frame;
  check::Net net;
  check::AckJoin ack;
  std::uint16_t island = check::kNoIsland;  // Of the sink, if the message shows it.
  if (frame.type == check::am::kNet && check::parse_net(frame.payload, net)) island = net.dest.pid;
  if (frame.type == check::am::kAckJoin && check::parse_ack_join(frame.payload, ack)) {
    island = ack.dest.pid;
  }
  // Takes the sink of that island, else whoever has the address, else strangers that have it.
  const auto matches = [&](const check::Device& device, bool exactly, bool known) {
    if (device.known != known || device.role == Role::kBaseStation) return false;
    return !exactly || device.role == Role::kMote || device.island == island;
  };
  const auto heard_by = of_am_.find(frame.dest);
  if (heard_by == of_am_.end()) return;
  for (const auto& [exactly, known] : {std::pair{true, true}, {false, true}, {false, false}}) {
    if (exactly && island == check::kNoIsland) continue;
    for (const std::uint16_t node : heard_by->second) {
      if (node != sender(i) && matches(who_.devices[node], exactly, known)) out.push_back(node);
    }
    if (!out.empty()) return;
  }
}

std::vector<std::uint16_t> Scene::receivers(std::size_t i) const {
  std::vector<std::uint16_t> out;
  const check::Observation& seen = run_.seen[i];
  const check::Mark& mark = who_.marks[i];
  if (mark.receiver != kNobody) {
    out.push_back(mark.receiver);
  } else if (seen.kind == Kind::kRadio) {
    add_radio_receivers(i, out);
  } else if (seen.kind == Kind::kSerial && mark.device != kNobody &&
             who_.devices[mark.device].partner != kNobody) {
    out.push_back(who_.devices[mark.device].partner);
  }
  return out;
}

bool Scene::concerns(std::size_t i, std::uint16_t node) const {
  if (sender(i) == node) return true;
  const std::vector<std::uint16_t> to = receivers(i);
  return std::find(to.begin(), to.end(), node) != to.end();
}

std::vector<std::uint16_t> Scene::topic(std::size_t i) const {
  const check::Observation& seen = run_.seen[i];
  std::vector<std::uint16_t> out;
  const auto add = [&](std::uint16_t id) {
    if (!sinks_.contains(id) && id != machine::kNullDevid && id != 0xFFFF) out.push_back(id);
  };
  if (seen.kind == Kind::kRadio) {
    add(seen.frame.src);
    add(seen.frame.dest);
  }
  check::Net net;
  if (seen.frame.type == check::am::kNet && check::parse_net(seen.frame.payload, net)) {
    add(net.src.devid);
    add(net.dest.devid);
  }
  return out;
}

bool Scene::is_echo(std::size_t i) const {
  return who_.marks[i].repeat || run_.seen[i].kind == Kind::kLinkAck;
}

std::string Scene::label(std::size_t i) const {
  const check::Observation& seen = run_.seen[i];
  if (seen.kind == Kind::kCall && seen.call) return events::from_call(*seen.call).name;
  if (seen.kind == Kind::kNotice && seen.notice) return events::from_notice(*seen.notice).name;
  if (seen.kind == Kind::kLinkAck) return fmt::format("link ack {}", seen.dsn);
  if (seen.kind == Kind::kDamaged) return "damaged";
  const trace::Message message = decoded(seen).message;
  if (message.name == "am") return "malformed " + value_of(message, "type");
  if (message.name == "net_msg") return net_label(message);
  const std::string seq = value_of(message, "seq_num");
  return seq.empty() ? message.name : message.name + " " + seq;
}

std::string Scene::message(std::size_t i) const {
  const check::Observation& seen = run_.seen[i];
  if (seen.kind == Kind::kCall && seen.call) return trace::print(events::from_call(*seen.call));
  if (seen.kind == Kind::kNotice && seen.notice) {
    return trace::print(events::from_notice(*seen.notice));
  }
  if (seen.kind == Kind::kLinkAck) return fmt::format("link acknowledgement of {}", seen.dsn);
  if (seen.kind == Kind::kDamaged) {
    return fmt::format("damaged, breaks {}", trace::requirement_text(seen.broken));
  }
  trace::Message message = decoded(seen).message;
  shorten(message);
  return without_long_words(trace::print(message));
}

std::string Scene::route(std::size_t i) const {
  const check::Observation& seen = run_.seen[i];
  const bool frame = seen.kind == Kind::kRadio || seen.kind == Kind::kSerial;
  if (!frame) return sender(i) == kNobody ? std::string() : name(sender(i));
  const std::string from = sender(i) != kNobody         ? name(sender(i))
                           : seen.kind == Kind::kSerial ? "serial line"
                                                        : address_text(seen.frame.src);
  const std::vector<std::uint16_t> to = receivers(i);
  std::string names = to.size() > 2 ? "all" : "";
  for (const std::uint16_t node : to) {
    if (to.size() <= 2) names += (names.empty() ? "" : ", ") + name(node);
  }
  if (to.empty()) {
    names = seen.kind == Kind::kSerial ? "serial line" : address_text(seen.frame.dest);
  }
  return from + " > " + names;
}

}  // namespace rubric::report
