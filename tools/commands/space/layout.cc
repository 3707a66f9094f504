#include "tools/commands/space/layout.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "codec/generated/rubicon/demo_data.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/read_updates.h"
#include "codec/generated/rubicon/updates.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/reflect/encode.h"
#include "conformance/machine/messages.h"
#include "tools/commands/run/names.h"

namespace rubric::space {
namespace {

using Json = nlohmann::ordered_json;
using std::string;

constexpr const char* kAll = "all";
constexpr std::size_t kTextMax = 64;  // Of ids and names that others choose.
constexpr std::size_t kDataMax = 100;

string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A mistake of whoever wrote a tuple.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Runs what may throw; returns what is wrong.
template <class Read>
string refusal_of(Read read) {
  try {
    read();
  } catch (const Refusal& wrong) {
    return wrong.what();
  } catch (const Json::exception& wrong) {
    return fmt::format("no JSON of this layout: {}", wrong.what());
  } catch (const std::invalid_argument& wrong) {
    return wrong.what();
  }
  return {};
}

Json object_of(std::string_view text) {
  Json json = Json::parse(text);
  if (!json.is_object()) throw Refusal("expected a JSON object");
  return json;
}

const Json& value_at(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) throw Refusal(fmt::format("{} is missing", name));
  return *found;
}

string text_at(const Json& json, const char* name, std::size_t max) {
  const Json& value = value_at(json, name);
  if (!value.is_string()) throw Refusal(fmt::format("{}: expected a text", name));
  string text = value.get<string>();
  if (text.size() > max) throw Refusal(fmt::format("{}: over {} bytes", name, max));
  return text;
}

template <class Number>
Number number_at(const Json& json, const char* name) {
  const Json& value = value_at(json, name);
  constexpr auto max = std::numeric_limits<Number>::max();
  if (!value.is_number_integer() || value < 0 || value > max) {
    throw Refusal(fmt::format("{}: expected a number from 0 to {}", name, max));
  }
  return value.get<Number>();
}

void check_keys(const Json& json, std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw Refusal(fmt::format("unknown key '{}'", key.substr(0, kTextMax)));
    }
  }
}

std::vector<std::uint8_t> bytes_at(const Json& json, const char* name, std::size_t max) {
  const string hex = text_at(json, name, 2 * max);
  std::vector<std::uint8_t> out;
  if (hex.find(' ') != hex.npos || !reflect::parse_hex(hex, out)) {
    throw Refusal(fmt::format("{}: expected bytes in hex", name));
  }
  return out;
}

string hex_of(Bytes bytes) { return fmt::format("{:02x}", fmt::join(bytes, "")); }

std::int64_t time_of(const string& text) {
  const std::string_view form = "0000-00-00T00:00:00.000Z";
  bool fits = text.size() == form.size();
  for (std::size_t i = 0; fits && i < form.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    fits = form[i] == '0' ? digit : text[i] == form[i];
  }
  if (!fits) throw Refusal("expected a time such as 2026-01-31T23:59:59.123Z");
  const auto number = [&](std::size_t at, std::size_t digits) {
    return std::stoi(text.substr(at, digits));
  };
  std::tm parts{};
  parts.tm_year = number(0, 4) - 1900;
  parts.tm_mon = number(5, 2) - 1;
  parts.tm_mday = number(8, 2);
  parts.tm_hour = number(11, 2);
  parts.tm_min = number(14, 2);
  parts.tm_sec = number(17, 2);
  const bool real = parts.tm_year >= 70 && parts.tm_mon >= 0 && parts.tm_mon < 12 &&
                    parts.tm_mday >= 1 && parts.tm_mday <= 31 && parts.tm_hour < 24 &&
                    parts.tm_min < 60 && parts.tm_sec <= 60;
  if (!real) throw Refusal("a time that is none");
  return std::int64_t{::timegm(&parts)} * 1000 + number(20, 3);
}

string names_at(const Json& json, const char* name) {
  string out;
  const Json& list = value_at(json, name);
  if (!list.is_array()) throw Refusal(fmt::format("{}: expected a list of names", name));
  for (const Json& each : list) {
    if (!each.is_string()) throw Refusal(fmt::format("{}: expected names", name));
    out += (out.empty() ? "" : ",") + each.get<string>();
  }
  return out;
}

std::optional<std::uint16_t> id_of(std::string_view text) {
  std::uint16_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  // One spelling of each key.
  const bool padded = text.size() > 1 && text.front() == '0';
  if (!whole || padded || machine::is_reserved(value)) return std::nullopt;
  return value;
}

Json reading(std::uint16_t raw, const Mote& mote, const string& sensor) {
  Json json = {{"raw", raw}};
  const reflect::Unit* const unit = run::unit_of(sensor);
  const auto telosb = static_cast<std::uint8_t>(rubicon::MoteType::kTelosbDemo);
  if (unit == nullptr || mote.descriptor.mote_type != telosb) return json;
  json["value"] = std::round((raw * unit->scale + unit->offset) * 1e4) / 1e4;
  json["unit"] = unit->symbol;
  return json;
}

}  // namespace

string net_key(std::uint16_t island) {
  return island == machine::kBroadcastPid ? fmt::format("{}/net", kAll)
                                          : fmt::format("{}/net", island);
}
string island_availability_key(std::uint16_t island) {
  return fmt::format("{}/availability", island);
}
string events_key(std::uint16_t island) { return fmt::format("{}/events", island); }
string mote_key(std::uint16_t island, std::uint16_t mote) {
  return fmt::format("{}/motes/{}", island, mote);
}
string state_key(std::uint16_t island, std::uint16_t mote) {
  return mote_key(island, mote) + "/state";
}
string availability_key(std::uint16_t island, std::uint16_t mote) {
  return mote_key(island, mote) + "/availability";
}

std::optional<Key> parse_key(std::string_view key) {
  std::vector<std::string_view> words;
  while (words.size() < 5) {
    const std::size_t end = std::min(key.find('/'), key.size());
    words.push_back(key.substr(0, end));
    if (end == key.size()) break;
    key.remove_prefix(end + 1);
  }
  Key out;
  if (words.size() == 2 && words[0] == kAll && words[1] == "net") {
    out.island = machine::kBroadcastPid;
    return out;
  }
  const std::optional<std::uint16_t> island = id_of(words[0]);
  if (!island || words.size() < 2) return std::nullopt;
  out.island = *island;
  if (words.size() == 2) {
    if (words[1] == "net") return out;
    out.kind = Key::Kind::kEvents;
    if (words[1] == "events") return out;
    out.kind = Key::Kind::kIslandAvailability;
    if (words[1] == "availability") return out;
    return std::nullopt;
  }
  const std::optional<std::uint16_t> mote = id_of(words[2]);
  if (words[1] != "motes" || !mote || words.size() > 4) return std::nullopt;
  out.mote = *mote;
  out.kind = Key::Kind::kMote;
  if (words.size() == 3) return out;
  out.kind = Key::Kind::kState;
  if (words[3] == "state") return out;
  out.kind = Key::Kind::kAvailability;
  if (words[3] == "availability") return out;
  out.kind = Key::Kind::kSet;
  if (words[3] == "set") return out;
  return std::nullopt;
}

string time_text(std::int64_t ms) {
  // Not by the system's clock, whose nanoseconds end in the year 2262.
  const auto at = std::chrono::floor<std::chrono::seconds>(std::chrono::milliseconds(ms));
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::time_t{at.count()}),
                     ms % 1000);
}

string payload_of(const Tuple& tuple) {
  Json json = {{"creator", tuple.creator}, {"time", time_text(tuple.written_ms)}};
  json["data"] = Json::parse(tuple.data);
  return text_of(json);
}

string parse_payload(std::string_view payload, Tuple& tuple) {
  return refusal_of([&] {
    if (payload.size() > kPayloadMax) throw Refusal(fmt::format("over {} bytes", kPayloadMax));
    const Json json = object_of(payload);
    if (!json.contains("creator")) {
      tuple.data = text_of(json);
      return;
    }
    check_keys(json, {"creator", "time", "data"});
    tuple.creator = text_at(json, "creator", kTextMax);
    tuple.written_ms = time_of(text_at(json, "time", kTextMax));
    if (!value_at(json, "data").is_object()) throw Refusal("data: expected a JSON object");
    tuple.data = text_of(json.at("data"));
  });
}

string availability_data(bool online) {
  return text_of({{"state", online ? "online" : "offline"}});
}

string net_data(Bytes packet) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  const std::uint16_t dest = header->dest();
  Json json = {{"src", header->src()}, {"dest", dest}};
  if (dest == machine::kBroadcastPid) json["dest"] = kAll;
  json["net_msg"] = hex_of(header->stale());
  return text_of(json);
}

string parse_net(const Tuple& tuple, std::vector<std::uint8_t>& packet) {
  return refusal_of([&] {
    const Json json = object_of(tuple.data);
    check_keys(json, {"src", "dest", "net_msg"});
    const std::optional<Key> key = parse_key(tuple.key);
    tinyos::AmHeader header;
    header.src = number_at<std::uint16_t>(json, "src");
    const bool all = value_at(json, "dest") == kAll;
    header.dest = all ? machine::kBroadcastPid : number_at<std::uint16_t>(json, "dest");
    if (machine::is_reserved(header.src)) throw Refusal("src: no island has this number");
    if (!key || key->kind != Key::Kind::kNet || key->island != header.dest) {
      throw Refusal("dest: not the island of the key");
    }
    const auto bytes = bytes_at(json, "net_msg", rubicon::NetMsgView::kMaxSizeBytes);
    const auto view = rubicon::NetMsgView::parse(Bytes(bytes.data(), bytes.size()));
    if (!view || !view->stale().empty()) throw Refusal("net_msg: malformed");
    header.dispatch = tinyos::Dispatch::kActiveMessage;
    header.type = machine::am::kNet;
    header.length = static_cast<std::uint8_t>(bytes.size());
    packet.resize(tinyos::AmHeaderView::kMaxSizeBytes);
    tinyos::AmHeaderLayout::store(header, packet.data());
    packet.insert(packet.end(), bytes.begin(), bytes.end());
  });
}

string mote_data(const Mote& mote) {
  return text_of({{"type", run::mote_type_name(mote.descriptor.mote_type)},
                  {"transducers", run::transducer_names(mote.descriptor.transducers)},
                  {"actuators", run::actuator_names(mote.descriptor.actuators)},
                  {"joined_at", time_text(mote.joined_ms)}});
}

string parse_mote(const string& data, Mote& mote) {
  return refusal_of([&] {
    const Json json = object_of(data);
    check_keys(json, {"type", "transducers", "actuators", "joined_at"});
    mote.descriptor.mote_type = run::mote_type_of(text_at(json, "type", kTextMax));
    mote.descriptor.transducers = run::transducers_of(names_at(json, "transducers"));
    mote.descriptor.actuators = run::actuators_of(names_at(json, "actuators"));
    mote.joined_ms = time_of(text_at(json, "joined_at", kTextMax));
  });
}

string state_data(const Mote& mote, std::uint8_t app_id, Bytes data) {
  Json json = Json::object();
  const auto add = [&](const string& sensor, std::uint16_t raw) {
    json[sensor] = reading(raw, mote, sensor);
  };
  if (app_id == machine::component::kControlLayer) {
    const auto view = rubicon::UpdatesView::parse(data);
    if (!view || view->type() != rubicon::AmType::kUpdates) return {};
    const rubicon::Updates updates = view->to_value();
    for (std::size_t i = 0; i < updates.updates.size(); ++i) {
      const rubicon::TransducerUpdate& update = updates.updates.items[i];
      const std::vector<string> names = run::transducer_names(update.transducer.raw());
      add(names.size() == 1 ? names.front() : fmt::format("0x{:04x}", update.transducer.raw()),
          update.value);
    }
  } else if (app_id == static_cast<std::uint8_t>(rubicon::Component::kMockup)) {
    const auto view = rubicon::DemoDataView::parse(data);
    if (!view || view->msg_type() != rubicon::AmType::kDemoData) return {};
    add("light", view->light());
    add("temp", view->temp());
    add("accel_x", view->accx());
    add("accel_y", view->accy());
    add("pir", view->pir());
    add("mic", view->mic());
    add("humid", view->humid());
    add("magnetic", view->magnetic());
    add("rssi", view->my_rssi());
  }
  return json.empty() ? string() : text_of(json);
}

string parse_wish(const string& data, Wish& wish) {
  return refusal_of([&] {
    const Json json = object_of(data);
    wish.app_id = machine::component::kControlLayer;
    if (json.contains("id")) wish.id = text_at(json, "id", kTextMax);
    if (json.contains("reliable")) {
      if (!json.at("reliable").is_boolean()) throw Refusal("reliable: true or false");
      wish.reliable = json.at("reliable").get<bool>();
    }
    if (json.contains("command")) {
      check_keys(json, {"id", "reliable", "command"});
      const string text = text_at(json, "command", kDataMax);
      if (text.empty()) throw Refusal("command: empty");
      wish.data.assign(text.begin(), text.end());
    } else if (json.contains("sampling_ms")) {
      check_keys(json, {"id", "reliable", "sampling_ms", "transducers"});
      rubicon::ReadUpdates message;
      message.type = rubicon::AmType::kReadUpdates;
      message.sampling_rate = number_at<std::uint16_t>(json, "sampling_ms");
      wish.transducers = run::transducers_of(names_at(json, "transducers"));
      message.transducers = rubicon::TransducerMask(wish.transducers);
      wish.data.resize(rubicon::ReadUpdatesView::kMaxSizeBytes);
      rubicon::ReadUpdatesLayout::store(message, wish.data.data());
    } else if (json.contains("data")) {
      check_keys(json, {"id", "reliable", "data", "app_id"});
      wish.data = bytes_at(json, "data", kDataMax);
      if (json.contains("app_id")) wish.app_id = number_at<std::uint8_t>(json, "app_id");
    } else {
      throw Refusal("expected command, sampling_ms or data");
    }
  });
}

string wish_event(const char* what, std::uint16_t mote, const string& id, const string& why) {
  Json json = {{"event", what}, {"mote", mote}};
  if (!id.empty()) json["id"] = id;
  if (!why.empty()) json["why"] = why;
  return text_of(json);
}

string sensor_topic(std::uint16_t island, std::uint16_t id, const string& sensor) {
  return fmt::format("homeassistant/sensor/rubicon_{}_{}/{}/config", island, id, sensor);
}

std::vector<Announcement> home_assistant(const string& root, std::uint16_t island, std::uint16_t id,
                                         const Mote& mote) {
  const auto availability = [&](const string& key) {
    return Json{{"topic", root + '/' + key}, {"value_template", "{{ value_json.data.state }}"}};
  };
  const string device = fmt::format("rubicon_{}_{}", island, id);
  std::vector<Announcement> out;
  for (const string& sensor : run::transducer_names(mote.descriptor.transducers)) {
    const Json shown = reading(0, mote, sensor);
    const char* const number = shown.contains("unit") ? "value" : "raw";
    Json json = {{"name", sensor},
                 {"unique_id", device + '_' + sensor},
                 {"state_topic", root + '/' + state_key(island, id)},
                 {"value_template", fmt::format("{{{{ value_json.data.{}.{} }}}}", sensor, number)},
                 {"state_class", "measurement"}};
    if (sensor == "temp" && shown.contains("unit")) {
      json["device_class"] = "temperature";
      json["unit_of_measurement"] = "\u00b0C";
    }
    json["availability"] = Json::array({availability(island_availability_key(island)),
                                        availability(availability_key(island, id))});
    json["availability_mode"] = "all";
    json["device"] = {{"identifiers", Json::array({device})},
                      {"name", fmt::format("mote {}:{}", island, id)},
                      {"model", run::mote_type_name(mote.descriptor.mote_type)}};
    out.push_back({sensor_topic(island, id, sensor), text_of(json)});
  }
  return out;
}

}  // namespace rubric::space
