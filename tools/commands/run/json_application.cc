#include "tools/commands/run/json_application.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "codec/reflect/encode.h"
#include "tools/format/put.h"

namespace rubric::run {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(node::Address one) { return fmt::format("{}:{}", one.pid, one.devid); }
std::string text_of(node::ChannelId id) { return fmt::format("{}->{}", id >> 16, id & 0xFFFF); }

void print(const Json& json) {
  fmt::print("{}\n", json.dump(-1, ' ', false, Json::error_handler_t::replace));
  std::fflush(stdout);
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
    if (!value.is_number()) throw std::invalid_argument(fmt::format("{}: a number", name));
    return value.get<float>();
  }
  node::Address address(const char* name) const {
    const auto [pid, devid] = two(name, ":");
    return {pid, devid};
  }
  node::ChannelId channel() const {
    const auto [from, to] = two("channel", "->");
    return node::ChannelId{from} << 16 | to;
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

 private:
  const Json& at(const char* name) const {
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
};

Json result(bool success) { return {{"event", "op_result"}, {"success", success}}; }
Json result(node::ChannelResult made) {
  return {{"event", "channel_result"}, {"channel", text_of(made.id)}, {"success", made.success}};
}

// Makes a call; returns its result, null if it has none.
Json made(const std::string& name, const CallArguments& with, node::Node& node) {
  if (name == "join") {
    node::Descriptor descriptor;
    descriptor.mote_type = static_cast<rubicon::MoteType>(with.number<std::uint8_t>("type"));
    descriptor.transducers = rubicon::TransducerMask(with.number("transducers"));
    descriptor.actuators = rubicon::ActuatorMask(with.number<std::uint8_t>("actuators"));
    node.join(descriptor);
    return nullptr;
  }
  if (name == "send") {
    const std::vector<std::uint8_t> data = with.bytes("data");
    const auto app_id = with.number<std::uint8_t>("app_id");
    const std::uint16_t number = node.send(with.address("dest"), app_id, with.flag("reliable"),
                                           Bytes(data.data(), data.size()));
    return {{"event", "send_result"}, {"seq_num", number}, {"success", number != node::kNoSeq}};
  }
  const auto mode = [&] {
    return with.flag("power_save") ? node::Mode::kPowerSave : node::Mode::kReliable;
  };
  const auto size = [&] { return with.number<std::uint8_t>("size"); };
  const auto pos = [&] { return with.number<std::uint8_t>("pos"); };
  if (name == "create_out") return result(node.create_out(with.address("dest"), size(), mode()));
  if (name == "create_in") return result(node.create_in(with.address("src"), size(), mode()));
  if (name == "dispose") return result(node.dispose(with.channel()));
  if (name == "start") return result(node.start_channel(with.channel()));
  if (name == "stop") return result(node.stop_channel(with.channel()));
  if (name == "write_output") {
    return result(node.write_output(with.channel(), pos(), with.real("value")));
  }
  if (name == "read_input") {
    const node::InputValue value = node.read_input(with.channel(), pos());
    return {{"event", "input_value"}, {"value", value.value}, {"success", value.success}};
  }
  if (name == "set_time_step") return result(node.set_time_step(with.number("clock")));
  if (name == "set_island_id") return result(node.set_island(with.number("island")));
  if (name == "get_clock") return {{"event", "clock"}, {"ms", node.clock_ms()}};
  throw std::invalid_argument(fmt::format("unknown call '{}'", name));
}

}  // namespace

void JsonApplication::joined(node::Address own, bool success) {
  refused_ = !success;
  print({{"event", "joined"}, {"own", text_of(own)}, {"success", success}});
}

void JsonApplication::mote_joined(node::Address mote, const node::Descriptor& descriptor) {
  print({{"event", "mote_joined"},
         {"mote", text_of(mote)},
         {"type", static_cast<int>(descriptor.mote_type)},
         {"transducers", descriptor.transducers.raw()},
         {"actuators", descriptor.actuators.raw()}});
}

void JsonApplication::received(node::Address src, std::uint8_t app_id, Bytes data) {
  std::string hex(2 * data.size(), '0');
  format::put_hex(hex.data(), data);
  print({{"event", "received"}, {"src", text_of(src)}, {"app_id", app_id}, {"data", hex}});
}

void JsonApplication::ack_received(std::uint8_t app_id, std::uint16_t seq_num, bool success) {
  print(
      {{"event", "ack_received"}, {"app_id", app_id}, {"seq_num", seq_num}, {"success", success}});
}

void JsonApplication::syn_data_received(node::ChannelId channel, node::DataStatus status) {
  const char* const names[] = {"new", "old", "unknown_channel"};
  print({{"event", "syn_data"},
         {"channel", text_of(channel)},
         {"status", names[static_cast<std::size_t>(status)]}});
}

void JsonApplication::call(const std::string& line, node::Node& node) {
  try {
    const Json json = Json::parse(line);
    if (!json.is_object()) throw std::invalid_argument("expected an object with \"call\"");
    const CallArguments with(json);
    const Json answer = made(with.text("call"), with, node);
    if (!answer.is_null()) print(answer);
  } catch (const std::invalid_argument& error) {
    print({{"event", "error"}, {"text", error.what()}});
  } catch (const Json::exception& error) {
    print({{"event", "error"}, {"text", error.what()}});
  }
}

bool JsonApplication::take_refusal() { return std::exchange(refused_, false); }

}  // namespace rubric::run
