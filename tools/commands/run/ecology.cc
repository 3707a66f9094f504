#include "tools/commands/run/ecology.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "codec/lines/line.h"
#include "codec/text/yaml.h"
#include "conformance/node/sizes.h"
#include "tools/commands/run/names.h"
#include "tools/commands/space/mqtt_space.h"

namespace rubric::run {
namespace {

constexpr std::uint16_t kFirstPort = 17754;
constexpr std::uint64_t kIdMax = 0xFFFC;

struct Mistake {
  int line;
  std::string text;
};

// An empty file has no place.
int line_of(const YAML::Node& node) { return std::max(node.Mark().line, 0) + 1; }

// Returns what is there in place of what was expected, for a message.
std::string given(const YAML::Node& node) {
  if (node.IsScalar()) return fmt::format("given '{}'", node.Scalar());
  return node.IsSequence() ? "given a list" : node.IsMap() ? "given keys and values" : "not given";
}

std::string text_of(const YAML::Node& node, const std::string& key) {
  if (!node.IsScalar()) {
    throw Mistake{line_of(node), fmt::format("{}: expected a text, {}", key, given(node))};
  }
  return node.Scalar();
}

std::uint64_t number_of(const YAML::Node& node, const std::string& key, std::uint64_t min,
                        std::uint64_t max) {
  const std::string text = text_of(node, key);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < min || value > max) {
    throw Mistake{line_of(node), fmt::format("{}: expected a number from {} to {}, given '{}'", key,
                                             min, max, text)};
  }
  return value;
}

// A name, or a list of names, as names with commas between them.
std::string list_of(const YAML::Node& node, const std::string& key) {
  if (!node.IsSequence()) return text_of(node, key);
  std::string out;
  for (const YAML::Node& each : node) out += (out.empty() ? "" : ",") + text_of(each, key);
  return out;
}

// Returns the values of a map by their keys, all of which must be known and have a value.
std::map<std::string, YAML::Node> values_of(const YAML::Node& node, const std::string& what,
                                            const std::vector<std::string>& known,
                                            const std::string& example) {
  if (!node.IsMap()) {
    throw Mistake{line_of(node), fmt::format("{}: expected keys and values, such as '{}', {}", what,
                                             example, given(node))};
  }
  std::map<std::string, YAML::Node> out;
  for (const auto& pair : node) {
    const std::string key = text_of(pair.first, "key");
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw Mistake{line_of(pair.first),
                    fmt::format("unknown key '{}'; {} has {}", key, what, fmt::join(known, ", "))};
    }
    if (pair.second.IsNull()) throw Mistake{line_of(pair.first), key + " has no value"};
    if (!out.emplace(key, pair.second).second) {
      throw Mistake{line_of(pair.first), key + " is given twice"};
    }
  }
  return out;
}

// Calls a parser of names whose mistakes lack their place.
template <class Parse>
auto named(const YAML::Node& node, const std::string& key, Parse parse) {
  try {
    return parse(list_of(node, key));
  } catch (const std::invalid_argument& error) {
    throw Mistake{line_of(node), fmt::format("{}: {}", key, error.what())};
  }
}

// Returns the command of an application.
std::string app_of(const YAML::Node& node, const std::string& key) {
  const std::string text = text_of(node, key);
  if (text != "-") return text;
  throw Mistake{line_of(node), key + ": expected a command: - is for one node at a terminal"};
}

// Does so where there is no demo.
std::string station_app_of(const YAML::Node& node, const std::string& key) {
  if (node.IsScalar() && node.Scalar() == "demo") {
    throw Mistake{line_of(node), key + ": the demo is a mote's"};
  }
  return app_of(node, key);
}

EcologyMote mote_of(const YAML::Node& node) {
  auto values = values_of(node, "a mote",
                          {"id", "type", "transducers", "actuators", "app", "target"}, "{id: 5}");
  if (!values.contains("id")) throw Mistake{line_of(node), "a mote needs an id"};
  EcologyMote mote;
  mote.id = static_cast<std::uint16_t>(number_of(values["id"], "id", node::kSinkId + 1, kIdMax));
  mote.descriptor = {1, actuators_of("led"), transducers_of("light")};
  if (const auto at = values.find("type"); at != values.end()) {
    mote.descriptor.mote_type = named(at->second, "type", mote_type_of);
  }
  if (const auto at = values.find("transducers"); at != values.end()) {
    mote.descriptor.transducers = named(at->second, "transducers", transducers_of);
  }
  if (const auto at = values.find("actuators"); at != values.end()) {
    mote.descriptor.actuators = named(at->second, "actuators", actuators_of);
  }
  if (values.contains("app")) mote.app = app_of(values["app"], "app");
  const bool joins = mote.app.empty() || mote.app == "demo";
  for (const char* key : {"type", "transducers", "actuators"}) {
    if (joins || !values.contains(key)) continue;
    throw Mistake{
        line_of(values[key]),
        fmt::format("{} is for a mote that joins by itself; its app's call says it", key)};
  }
  if (const auto at = values.find("target"); at != values.end()) {
    mote.target = text_of(at->second, "target");
  }
  return mote;
}

std::string radio_of(const YAML::Node& node) {
  const std::string text = text_of(node, "radio");
  try {
    const auto address = lines::parse_address(text);
    if (address && address->kind == lines::Address::Kind::kAir) return text;
  } catch (const std::invalid_argument&) {
  }
  throw Mistake{line_of(node), fmt::format("radio: '{}': expected zep:PORT", text)};
}

std::string serial_of(const YAML::Node& node) {
  const std::string text = text_of(node, "serial");
  const std::string server = "sf-server:";
  if (text == "pty") return text;
  if (text.starts_with(server)) {
    std::uint16_t port = 0;
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data() + server.size(), end, port);
    if (error == std::errc() && at == end) return text;
  }
  throw Mistake{line_of(node), fmt::format("serial: '{}': expected sf-server:PORT or pty", text)};
}

EcologyIsland island_of(const YAML::Node& node, std::size_t index) {
  auto values = values_of(node, "an island",
                          {"island", "radio", "serial", "app", "sink_app", "motes"}, "island: 11");
  if (!values.contains("island")) throw Mistake{line_of(node), "an island needs its number"};
  EcologyIsland island;
  island.island = static_cast<std::uint16_t>(number_of(values["island"], "island", 1, kIdMax));
  island.radio = values.contains("radio") ? radio_of(values["radio"])
                                          : fmt::format("zep:{}", kFirstPort + index);
  if (values.contains("serial")) island.serial = serial_of(values["serial"]);
  if (values.contains("app")) island.app = station_app_of(values["app"], "app");
  if (values.contains("sink_app")) island.sink_app = station_app_of(values["sink_app"], "sink_app");
  if (!island.serial.empty() && !island.app.empty()) {
    throw Mistake{line_of(values["app"]),
                  "app is the base station's, which is the program at 'serial'"};
  }
  if (!values.contains("motes")) return island;
  if (!values["motes"].IsSequence()) {
    throw Mistake{line_of(values["motes"]),
                  "motes: expected a list, such as '[{id: 5}]', " + given(values["motes"])};
  }
  std::set<std::uint16_t> ids;
  for (const YAML::Node& each : values["motes"]) {
    island.motes.push_back(mote_of(each));
    if (!ids.insert(island.motes.back().id).second) {
      throw Mistake{line_of(each), fmt::format("island {} has a mote {} already", island.island,
                                               island.motes.back().id)};
    }
  }
  return island;
}

// Says which two islands cannot have what each of them asks for.
void check_island(const YAML::Node& node, const EcologyIsland& island, const Ecology& others) {
  for (const EcologyIsland& other : others.islands) {
    if (other.island == island.island) {
      throw Mistake{line_of(node), fmt::format("there is an island {} already", island.island)};
    }
    const bool server = island.serial.starts_with("sf-server:") && island.serial != "sf-server:0";
    if (server && other.serial == island.serial) {
      throw Mistake{line_of(node["serial"]),
                    fmt::format("{} is island {}'s", island.serial, other.island)};
    }
    if (other.radio != island.radio || island.radio == "zep:0") continue;
    for (const EcologyMote& mote : island.motes) {
      for (const EcologyMote& twin : other.motes) {
        if (mote.id != twin.id) continue;
        throw Mistake{line_of(node),
                      fmt::format("island {} on the same air, {}, has a mote {}, too", other.island,
                                  island.radio, mote.id)};
      }
    }
  }
}

void check_space(const YAML::Node& node) {
  const std::string expected = "space: expected memory or mqtt://HOST:PORT/ROOT, " + given(node);
  if (!node.Scalar().starts_with("mqtt")) throw Mistake{line_of(node), expected};
  try {
    space::parse_mqtt(node.Scalar());
  } catch (const std::invalid_argument& error) {
    throw Mistake{line_of(node), fmt::format("space: {}", error.what())};
  }
}

Ecology ecology_of(const YAML::Node& node) {
  auto values =
      values_of(node, "the file", {"loss", "seed", "space", "islands"}, "islands: [{island: 11}]");
  Ecology out;
  if (values.contains("loss")) {
    out.loss_percent =
        static_cast<std::uint32_t>(number_of(values["loss"], "loss in percent", 0, 100));
  }
  if (values.contains("seed")) out.seed = number_of(values["seed"], "seed", 0, UINT32_MAX);
  if (values.contains("space")) {
    out.space = text_of(values["space"], "space");
    if (out.space == "memory") out.space.clear();
    if (!out.space.empty()) check_space(values["space"]);
  }
  if (!values.contains("islands")) throw Mistake{line_of(node), "the file has no 'islands'"};
  if (!values["islands"].IsSequence()) {
    throw Mistake{line_of(values["islands"]),
                  "islands: expected a list, such as '- island: 11', " + given(values["islands"])};
  }
  for (const YAML::Node& each : values["islands"]) {
    EcologyIsland island = island_of(each, out.islands.size());
    check_island(each, island, out);
    out.islands.push_back(std::move(island));
  }
  if (out.islands.empty()) throw Mistake{line_of(values["islands"]), "there is no island"};
  return out;
}

// Says in plain words what the reader of YAML finds wrong.
std::string syntax_error(const YAML::Exception& error, const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 0; number <= error.mark.line; ++number) std::getline(lines, line);
  const std::string begin = line.substr(0, line.find_first_not_of(" \t"));
  if (begin.find('\t') != begin.npos) return "a tab before the text: YAML takes spaces";
  if (error.msg == YAML::ErrorMsg::END_OF_SEQ || error.msg == YAML::ErrorMsg::END_OF_MAP) {
    return "begins at no column of a list or key above";
  }
  if (error.msg == YAML::ErrorMsg::END_OF_MAP_FLOW ||
      error.msg == YAML::ErrorMsg::END_OF_SEQ_FLOW) {
    return "no comma or bracket where one must be; a text with a colon or comma needs quotes";
  }
  return "no YAML: " + error.msg;
}

}  // namespace

Ecology parse_ecology(const std::string& text, const std::string& name) {
  try {
    return ecology_of(text::only_yaml_document(text));
  } catch (const Mistake& mistake) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, mistake.line, mistake.text));
  } catch (const text::BehindDocument& behind) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, behind.mark.line + 1, behind.msg));
  } catch (const YAML::Exception& broken) {
    throw std::runtime_error(
        fmt::format("{}:{}: {}", name, broken.mark.line + 1, syntax_error(broken, text)));
  }
}

}  // namespace rubric::run
