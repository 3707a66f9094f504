#include "tools/commands/monitor/board.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "conformance/check/message.h"
#include "tools/commands/run/names.h"

namespace rubric::monitor {
namespace {

using machine::Address;

constexpr std::size_t kNodesMax = 4096;  // Anybody may write any address.
constexpr std::size_t kLastMax = 100;
constexpr std::uint16_t kSinkId = 1;
constexpr std::int64_t kPublishedMs = 2000;  // By then the space has what a line has shown.

std::string clock_text(std::int64_t now_ms) {
  return fmt::format("{:%H:%M:%S}", fmt::localtime(static_cast<std::time_t>(now_ms / 1000)));
}

std::string name_of(Address address) {
  if (address.devid == machine::kNullDevid) return fmt::format("{}:pc", address.pid);
  if (address.devid == kSinkId) return fmt::format("{}:sink", address.pid);
  return fmt::format("{}:{}", address.pid, address.devid);
}

// "light 512, temp 21.5 degC". The data may be anybody's.
std::string readings_text(const std::string& data) {
  const auto json = nlohmann::json::parse(data, nullptr, false);
  std::string out;
  if (!json.is_object()) return out;
  for (const auto& [sensor, reading] : json.items()) {
    if (!reading.is_object()) continue;
    const auto value = reading.find("value");
    const auto raw = reading.find("raw");
    const auto unit = reading.find("unit");
    const bool converted = value != reading.end() && value->is_number();
    if (!converted && (raw == reading.end() || !raw->is_number())) continue;
    out +=
        fmt::format("{}{} {}", out.empty() ? "" : ", ", sensor, (converted ? *value : *raw).dump());
    if (converted && unit != reading.end() && unit->is_string()) {
      out += ' ' + unit->get<std::string>();
    }
  }
  return out;
}

std::string description_text(const space::Mote& mote) {
  const machine::Descriptor& it = mote.descriptor;
  std::string out = run::mote_type_name(it.mote_type);
  for (const std::string& name : run::transducer_names(it.transducers)) out += ' ' + name;
  const std::vector<std::string> actuators = run::actuator_names(it.actuators);
  if (!actuators.empty()) out += " /";
  for (const std::string& name : actuators) out += ' ' + name;
  return out;
}

}  // namespace

Board::Node* Board::node(Address address) {
  // The PC's devid is reserved for others only.
  const bool pc = address.devid == machine::kNullDevid;
  if (address.pid == 0 || machine::is_reserved(address.pid)) return nullptr;
  if (address.devid == 0 || (machine::is_reserved(address.devid) && !pc)) return nullptr;
  const auto found = nodes_.find(address);
  if (found != nodes_.end()) return &found->second;
  if (nodes_.size() >= kNodesMax) {
    ++unlisted_;
    return nullptr;
  }
  return &nodes_[address];
}

void Board::add_news(const std::string& text, std::int64_t now_ms) {
  news_.push_back(clock_text(now_ms) + ' ' + text);
  last_.push_back(news_.back());
  if (last_.size() > kLastMax) last_.pop_front();
}

void Board::set_gone(Address address, Node& node, bool gone, const char* why, std::int64_t now_ms) {
  if (node.gone == gone) return;
  node.gone = gone;
  add_news(fmt::format("{} {}", name_of(address), why), now_ms);
}

void Board::heard(Address address, Node& node, std::int64_t now_ms) {
  node.heard_ms = now_ms;
  node.on_line = true;
  ++node.frames;
  set_gone(address, node, false, "is heard again", now_ms);
}

void Board::joined(Address address, const machine::Descriptor& descriptor, std::int64_t now_ms) {
  Node* const it = node(address);
  if (it == nullptr) return;
  // A sink reports on the serial line what the air has shown.
  const bool known =
      it->mote && it->mote->descriptor == descriptor && now_ms - it->mote->joined_ms < 1000;
  it->heard_ms = now_ms;
  it->gone = false;
  if (known) return;
  it->mote = space::Mote{descriptor, now_ms};
  ++it->joins;
  add_news(fmt::format("{} joined{}: {}", name_of(address), it->joins > 1 ? " again" : "",
                       description_text(*it->mote)),
           now_ms);
}

void Board::read(Address address, Node& node, const std::string& data, bool by_space,
                 std::int64_t now_ms) {
  std::string text = readings_text(data);
  if (text.empty()) return;
  // What a line has shown, the base station publishes in the space.
  const bool told = by_space != node.by_space && now_ms - node.told_ms < kPublishedMs;
  if (told && text == node.readings) return;
  node.readings = std::move(text);
  node.by_space = by_space;
  node.told_ms = now_ms;
  add_news(fmt::format("{} {}", name_of(address), node.readings), now_ms);
}

void Board::take(const check::Observation& seen, std::int64_t now_ms) {
  using Kind = check::Observation::Kind;
  if (seen.kind != Kind::kRadio && seen.kind != Kind::kSerial) return;
  check::AckJoin ack;
  if (seen.frame.type == check::am::kAckJoin && check::parse_ack_join(seen.frame.payload, ack)) {
    if (Node* const it = node(ack.src)) it->on_line = true;
    return joined(ack.src, ack.descriptor, now_ms);
  }
  check::Net net;
  if (seen.frame.type != check::am::kNet || !check::parse_net(seen.frame.payload, net)) return;
  Node* const from = node(net.src);
  if (from == nullptr) return;
  if (seen.kind == Kind::kRadio && seen.has_dsn) {
    // The same frame of the link once more: its acknowledgement was lost, or it was.
    const Bytes was(from->payload.data(), from->payload.size());
    if (seen.dsn == from->dsn && equal(was, seen.frame.payload)) ++from->repeats;
    from->dsn = seen.dsn;
    from->payload.assign(seen.frame.payload.begin(), seen.frame.payload.end());
  }
  heard(net.src, *from, now_ms);
  // Each tap sees a message that is passed on.
  const bool again = from->has_number && from->number == net.seq_num;
  from->number = net.seq_num;
  from->has_number = true;
  if (again) return;
  check::SerialJoined report;
  if (check::parse_serial_joined(net, report)) {
    if (Node* const it = node(report.address)) it->on_line = true;
    return joined(report.address, report.descriptor, now_ms);
  }
  if (!net.sound || net.trans_id != check::component::kConnless) return;
  const space::Mote mote = from->mote.value_or(space::Mote{});
  read(net.src, *from, space::state_data(mote, net.app_id, net.body()), false, now_ms);
}

void Board::take(const space::Tuple& tuple, std::int64_t now_ms) {
  const std::optional<space::Key> key = space::parse_key(tuple.key);
  if (!key || !tuple.wrong.empty()) {
    const std::string why = key ? tuple.wrong : "no key of the layout";
    return add_news(fmt::format("refused {}: {}", tuple.key, why), now_ms);
  }
  using Kind = space::Key::Kind;
  const auto json = nlohmann::json::parse(tuple.data, nullptr, false);
  const bool online = json.is_object() && json.value("state", nlohmann::json()) == "online";
  if (key->kind == Kind::kIslandAvailability) {
    const auto [island, fresh] = islands_.try_emplace(key->island, online);
    if (!fresh && island->second == online) return;
    island->second = online;
    return add_news(fmt::format("{}:pc {}", key->island, online ? "is online" : "has gone"),
                    now_ms);
  }
  const Address address{key->island, key->mote};
  if (key->kind != Kind::kMote && key->kind != Kind::kState && key->kind != Kind::kAvailability) {
    return;
  }
  Node* const it = node(address);
  if (it == nullptr) return;
  const std::int64_t at_ms = tuple.written_ms != 0 ? tuple.written_ms : now_ms;
  if (key->kind == Kind::kMote) {
    space::Mote mote;
    const std::string wrong = space::parse_mote(tuple.data, mote);
    if (!wrong.empty()) return add_news(fmt::format("refused {}: {}", tuple.key, wrong), now_ms);
    return joined(address, mote.descriptor, at_ms);
  }
  if (key->kind == Kind::kState) {
    it->heard_ms = at_ms;
    if (!it->on_line) ++it->frames;
    // What stays may be older than what was said of its going.
    if (!tuple.stays) set_gone(address, *it, false, "is heard again", now_ms);
    return read(address, *it, tuple.data, true, now_ms);
  }
  if (!it->gone && !online && it->heard_ms == 0) it->heard_ms = at_ms;
  set_gone(address, *it, !online, online ? "is heard again" : "has gone", now_ms);
}

void Board::look(std::int64_t now_ms) {
  if (silent_ms_ == 0) return;
  for (auto& [address, node] : nodes_) {
    if (node.on_line && now_ms - node.heard_ms >= silent_ms_) {
      set_gone(address, node, true, "is silent", now_ms);
    }
  }
}

std::vector<std::string> Board::take_news() { return std::exchange(news_, {}); }

std::vector<std::string> Board::table(std::int64_t now_ms) const {
  std::vector<std::string> out;
  out.push_back(fmt::format("{:<12} {:>7} {:>7} {:>7} {:>5}  {}", "NODE", "HEARD", "FRAMES",
                            "REPEATS", "JOINS", "READINGS, OR WHAT IT IS"));
  for (const auto& [address, node] : nodes_) {
    std::string heard = "-";
    if (node.gone) {
      heard = "gone";
    } else if (node.heard_ms != 0) {
      heard = fmt::format("{} s", std::max<std::int64_t>(0, (now_ms - node.heard_ms) / 1000));
    }
    std::string what = node.readings;
    if (what.empty() && node.mote) what = description_text(*node.mote);
    const auto island = islands_.find(address.pid);
    if (island != islands_.end() && !island->second) what += " (its base station has gone)";
    out.push_back(fmt::format("{:<12} {:>7} {:>7} {:>7} {:>5}  {}", name_of(address), heard,
                              node.frames, node.repeats, node.joins, what));
  }
  if (unlisted_ != 0) out.push_back(fmt::format("{} frames of more nodes", unlisted_));
  return out;
}

std::vector<std::string> Board::last_news(std::size_t count) const {
  const std::size_t from = last_.size() - std::min(count, last_.size());
  return {last_.begin() + static_cast<std::ptrdiff_t>(from), last_.end()};
}

}  // namespace rubric::monitor
