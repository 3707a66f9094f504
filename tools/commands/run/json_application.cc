#include "tools/commands/run/json_application.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "codec/reflect/encode.h"
#include "tools/commands/run/names.h"
#include "tools/format/put.h"

namespace rubric::run {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(machine::Address one) { return fmt::format("{}:{}", one.pid, one.devid); }
std::string channel_text(machine::ChannelId id) {
  return fmt::format("{}->{}", id >> 16, id & 0xFFFF);
}

std::uint16_t number_in(std::string_view text) {
  std::uint16_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(fmt::format("'{}' is not a number up to 65535", text));
  }
  return value;
}

// The arguments of a call. Each getter throws std::invalid_argument.
class CallArguments {
 public:
  explicit CallArguments(const Json& json) : json_(json) {}

  template <class Number = std::uint16_t>
  Number number(const char* name) const {
    const Json& value = at(name);
    if (!value.is_number_integer() || value < 0 || value > std::numeric_limits<Number>::max()) {
      throw std::invalid_argument(fmt::format("{}: expected a number from 0 to {}", name,
                                              std::numeric_limits<Number>::max()));
    }
    return value.get<Number>();
  }
  bool flag(const char* name) const {
    const Json& value = at(name);
    if (!value.is_boolean()) throw std::invalid_argument(fmt::format("{}: true or false", name));
    return value.get<bool>();
  }
  float real(const char* name) const {
    const Json& value = at(name);
    constexpr double max = std::numeric_limits<float>::max();
    if (!value.is_number() || std::abs(value.get<double>()) > max) {
      throw std::invalid_argument(fmt::format("{}: expected a number that a float holds", name));
    }
    return value.get<float>();
  }
  machine::Address address(const char* name) const {
    const auto [pid, devid] = two(name, ":");
    return {pid, devid};
  }
  machine::ChannelId channel() const {
    const auto [from, to] = two("channel", "->");
    return machine::ChannelId{from} << 16 | to;
  }
  std::vector<std::uint8_t> bytes(const char* name) const {
    const std::string hex = text(name);
    std::vector<std::uint8_t> out;
    const bool spaced = hex.find(' ') != hex.npos;
    if (spaced || !reflect::parse_hex(hex, out))
      throw std::invalid_argument(fmt::format("{}: expected bytes in hex", name));
    return out;
  }
  std::string text(const char* name) const {
    const Json& value = at(name);
    if (!value.is_string()) throw std::invalid_argument(fmt::format("{}: expected a text", name));
    return value.get<std::string>();
  }
  /// Throws if there are more than were asked for.
  void check_all_known() const {
    for (const auto& [key, value] : json_.items()) {
      if (!known_.contains(key)) throw std::invalid_argument(fmt::format("unknown key '{}'", key));
    }
  }

 private:
  const Json& at(const char* name) const {
    known_.insert(name);
    const auto found = json_.find(name);
    if (found == json_.end()) throw std::invalid_argument(fmt::format("{} is missing", name));
    return *found;
  }
  std::pair<std::uint16_t, std::uint16_t> two(const char* name, std::string_view between) const {
    const std::string both = text(name);
    const std::size_t at = both.find(between);
    if (at == both.npos) throw std::invalid_argument(fmt::format("{}: no '{}'", name, between));
    const std::string_view view = both;
    return {number_in(view.substr(0, at)), number_in(view.substr(at + between.size()))};
  }

  const Json& json_;
  mutable std::set<std::string> known_;
};

machine::Call call_of(const std::string& name, const CallArguments& with,
                      std::vector<std::uint8_t>& data) {
  const auto mode = [&] {
    return with.flag("power_save") ? machine::Mode::kPowerSave : machine::Mode::kReliable;
  };
  const auto link = [&] {
    const std::string text = with.text("link");
    if (text == "radio") return machine::Link::kRadio;
    if (text == "serial") return machine::Link::kSerial;
    throw std::invalid_argument("link: radio or serial");
  };
  const auto size = [&] { return with.number<std::uint8_t>("size"); };
  const auto pos = [&] { return with.number<std::uint8_t>("pos"); };
  if (name == "join") {
    machine::Descriptor descriptor;
    descriptor.mote_type = with.number<std::uint8_t>("type");
    descriptor.transducers = with.number("transducers");
    descriptor.actuators = with.number<std::uint8_t>("actuators");
    return machine::JoinIsland{descriptor};
  }
  if (name == "send") {
    data = with.bytes("data");
    return machine::Send{with.address("dest"), with.number<std::uint8_t>("app_id"),
                         with.flag("reliable"), Bytes(data.data(), data.size())};
  }
  if (name == "interface") return machine::SetInterface{link(), with.flag("on")};
  if (name == "get_interface") return machine::GetInterface{link()};
  if (name == "create_out") {
    return machine::CreateChannel{machine::Direction::kOut, with.address("dest"), size(), mode()};
  }
  if (name == "create_in") {
    return machine::CreateChannel{machine::Direction::kIn, with.address("src"), size(), mode()};
  }
  if (name == "dispose") return machine::DisposeChannel{with.channel()};
  if (name == "start") return machine::StartChannel{with.channel()};
  if (name == "stop") return machine::StopChannel{with.channel()};
  if (name == "start_all") return machine::StartAllChannels{};
  if (name == "stop_all") return machine::StopAllChannels{};
  if (name == "write_output") {
    return machine::WriteOutput{with.channel(), pos(), with.real("value")};
  }
  if (name == "read_input") return machine::ReadInput{with.channel(), pos()};
  if (name == "set_time_step") return machine::SetTimeStep{with.number("clock")};
  if (name == "set_island_id") return machine::SetIslandId{with.number("island")};
  if (name == "get_clock") return machine::GetClock{};
  throw std::invalid_argument(fmt::format("unknown call '{}'", name));
}

// An event of each kind, by overloading.
struct EventOf {
  Json operator()(const machine::Joined& it) const {
    return {{"event", "joined"}, {"own", text_of(it.address)}, {"success", it.success}};
  }
  Json operator()(const machine::MoteJoined& it) const {
    return {{"event", "mote_joined"},
            {"mote", text_of(it.address)},
            {"type", it.descriptor.mote_type},
            {"transducers", it.descriptor.transducers},
            {"actuators", it.descriptor.actuators}};
  }
  Json operator()(const machine::MoteLeft& it) const {
    return {{"event", "mote_left"}, {"mote", text_of(it.address)}};
  }
  Json operator()(const machine::SendResult& it) const {
    return {{"event", "send_result"},
            {"seq_num", it.seq_num},
            {"success", it.seq_num != machine::kNoSeq}};
  }
  Json operator()(const machine::Received& it) const {
    std::string hex(2 * it.data.size(), '0');
    format::put_hex(hex.data(), it.data);
    return {{"event", "received"}, {"src", text_of(it.src)}, {"app_id", it.app_id}, {"data", hex}};
  }
  Json operator()(const machine::AckReceived& it) const {
    return {{"event", "ack_received"},
            {"app_id", it.app_id},
            {"seq_num", it.seq_num},
            {"success", it.success}};
  }
  Json operator()(const machine::SynDataReceived& it) const {
    const char* const names[] = {"new", "old", "unknown_channel"};
    return {{"event", "syn_data"},
            {"channel", channel_text(it.id)},
            {"status", names[static_cast<std::size_t>(it.status)]}};
  }
  Json operator()(const machine::ChannelResult& it) const {
    return {{"event", "channel_result"}, {"channel", channel_text(it.id)}, {"success", it.success}};
  }
  Json operator()(const machine::OperationResult& it) const {
    return {{"event", "op_result"}, {"success", it.success}};
  }
  Json operator()(const machine::InputValue& it) const {
    return {{"event", "input_value"}, {"value", it.value}, {"success", it.success}};
  }
  Json operator()(const machine::InterfaceState& it) const {
    return {{"event", "interface_state"},
            {"link", it.link == machine::Link::kRadio ? "radio" : "serial"},
            {"on", it.on}};
  }
  Json operator()(const machine::Clock& it) const { return {{"event", "clock"}, {"ms", it.ms}}; }
};

std::string line_of(const Json& event, const std::string& node) {
  Json json;
  if (!node.empty()) json["node"] = node;
  json.update(event);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string json_line(const machine::Notice& notice, const std::string& node) {
  return line_of(std::visit(EventOf(), notice), node);
}

void JsonApplication::happened(const machine::Notice& notice, Caller&) {
  print(json_line(notice, ends_.node));
}

lines::SteadyTime JsonApplication::run(Caller& caller) {
  pollfd input{fd(), POLLIN, 0};
  if (fd() >= 0 && ::poll(&input, 1, 0) > 0) read(caller);
  constexpr lines::Milliseconds kAgain{20};
  return ends_.out->flush() ? lines::SteadyTime::max() : std::chrono::steady_clock::now() + kAgain;
}

void JsonApplication::stop(Caller&) {
  if (!ends_.shared) ends_.out->finish(std::chrono::steady_clock::now() + kLastWords);
}

void JsonApplication::read(Caller& caller) {
  char room[4096];
  const ssize_t size = ::read(ends_.in, room, sizeof room);
  if (size <= 0) {
    ended_ = size == 0 || (errno != EINTR && errno != EAGAIN);
    const std::string last = ended_ ? input_.rest() : "";
    if (!last.empty()) call(last, caller);
    return;
  }
  input_.add(
      {room, static_cast<std::size_t>(size)}, [&](const std::string& line) { call(line, caller); },
      [&] { print_error(fmt::format("a line of more than {} bytes", kLineMax)); });
}

void JsonApplication::print_error(const std::string& text) {
  print(line_of({{"event", "error"}, {"text", text}}, ends_.node));
}

void JsonApplication::call(const std::string& line, Caller& caller) {
  try {
    const Json json = Json::parse(line);
    if (!json.is_object()) throw std::invalid_argument("expected an object with \"call\"");
    const CallArguments with(json);
    std::vector<std::uint8_t> data;
    const machine::Call call = call_of(with.text("call"), with, data);
    with.check_all_known();
    const auto answer = caller.call(call);
    if (!answer) return;
    Json event = std::visit(EventOf(), *answer);
    const auto* const sent = std::get_if<machine::SendResult>(&*answer);
    if (sent != nullptr && sent->seq_num == machine::kNoSeq) {
      event["why"] = refusal_text(caller.refusal(std::get<machine::Send>(call)));
    }
    print(line_of(event, ends_.node));
  } catch (const std::invalid_argument& error) {
    print_error(error.what());
  } catch (const Json::exception& error) {
    print_error(fmt::format("no JSON: {}", error.what()));
  }
}

}  // namespace rubric::run
