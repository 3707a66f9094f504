#include "conformance/simulate/scenarios.h"

#include <cassert>
#include <memory>
#include <string>
#include <utility>

#include "codec/generated/rubicon/enums.h"
#include "conformance/generated/profiles.h"
#include "conformance/simulate/script.h"

namespace rubric::simulate {
namespace {

using machine::Address;
using machine::kLocalPid;
using machine::kNullDevid;

constexpr std::uint16_t kIsland = 11;
constexpr std::uint16_t kOtherIsland = 12;
constexpr std::uint16_t kSinkId = 1;
constexpr Micros kHalfSecondUs = us_of(500);  // TinyOS' 500 ms.
constexpr Micros kBinaryMsUs = us_of(1);

constexpr auto kControl = static_cast<std::uint8_t>(rubicon::Component::kControlLayer);
constexpr std::uint16_t kLight = 0x0001;
constexpr std::uint16_t kTemp = 0x0002;
constexpr std::uint16_t kPir = 0x0010;
constexpr std::uint16_t kHumid = 0x0040;
constexpr std::uint16_t kRssi = 0x1F00;
constexpr std::uint8_t kLed = 0x01;
constexpr std::uint8_t kOpen = 0x02;
constexpr machine::Descriptor kStandard{1, kLed, kLight | kTemp | kHumid};
constexpr machine::Descriptor kPirMote{2, kLed, kPir};
constexpr machine::Descriptor kRobot{1, kLed, kRssi};
constexpr machine::Descriptor kDoor{1, kOpen, kLight};

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

// Builds networks.
class Builder {
 public:
  explicit Builder(const ScenarioOptions& options) : options_(options) {
    network_.seed = options.seed;
  }

  std::size_t radio(std::string name) {
    RadioPlan plan{.name = std::move(name)};
    plan.faults.loss = options_.loss;
    plan.faults.duplication = options_.duplication;
    network_.radios.push_back(std::move(plan));
    return network_.radios.size() - 1;
  }
  NodeId mote(std::uint16_t id, std::size_t radio, Script script) {
    return node("m" + std::to_string(id), machine::Role::kMote, id, 0, radio, std::move(script));
  }
  /// Adds a sink, its base station, and the line between them. Letters tell islands apart.
  void island(char letter, std::uint16_t island, std::size_t radio, Script sink = {},
              Script base_station = {}) {
    SerialPlan line{.name = std::string("ser") + letter,
                    .sink = node(std::string("s") + letter, machine::Role::kSink, kSinkId, island,
                                 radio, std::move(sink)),
                    .base_station = node(std::string("b") + letter, machine::Role::kBaseStation, 0,
                                         island, 0, std::move(base_station))};
    network_.serials.push_back(std::move(line));
  }
  void anchor(std::size_t radio, std::uint8_t number) {
    BeaconPlan beacon{.radio = radio, .am_address = static_cast<std::uint16_t>(200 + number)};
    beacon.am_type = static_cast<std::uint8_t>(rubicon::AmType::kTemp);  // Release 1.0 uses it too.
    beacon.payload = {number};
    beacon.first_us = number * 10'000;  // One after the other.
    beacon.period_us = kHalfSecondUs;
    network_.beacons.push_back(std::move(beacon));
  }
  Network done() { return std::move(network_); }

 private:
  NodeId node(std::string name, machine::Role role, std::uint16_t id, std::uint16_t island,
              std::size_t radio, Script script) {
    NodePlan plan{.name = std::move(name)};
    plan.config.role = role;
    plan.config.id = id;
    plan.config.island = island;
    plan.config.profile = machine::kPaper;
    plan.config.random_seq = true;
    // Distinct numbers, the same for the same seed.
    Random random(options_.seed * 1'000 + network_.nodes.size());
    plan.config.first_seq = static_cast<std::uint16_t>(random.between(1, 0xFFFE));
    plan.application = std::make_unique<ScriptedApplication>(std::move(script));
    plan.radio = radio;
    network_.nodes.push_back(std::move(plan));
    return network_.nodes.size() - 1;
  }

  const ScenarioOptions& options_;
  Network network_;
};

Script joining(Micros join_us, machine::Descriptor descriptor) {
  return {.join_us = join_us, .descriptor = descriptor};
}

// Sends updates to the PC of its island, through the sink.
ScriptedSend updates(std::uint16_t transducers, Micros period_us = kHalfSecondUs) {
  return {.dest = {kLocalPid, kNullDevid},
          .app_id = kControl,
          .readings_of = transducers,
          .first_us = period_us,
          .period_us = period_us};
}

Script sensor(Micros join_us) {
  Script script = joining(join_us, kStandard);
  script.sends.push_back(updates(kLight | kTemp | kHumid));
  return script;
}

ScriptedSend reliable(Address dest, std::string_view text, Micros first_us, Micros period_us) {
  return {.dest = dest,
          .app_id = kControl,
          .reliable = true,
          .data = bytes_of(text),
          .first_us = first_us,
          .period_us = period_us};
}

// Paper: Fig. "Timeline of join and data acquisition", whose times are milliseconds; a period of
// 500 is one of TinyOS timers, in ticks.
Network timeline(const ScenarioOptions& options) {
  Builder builder(options);
  const std::size_t air = builder.radio("rA");
  builder.island('A', kIsland, air);
  builder.mote(2, air, sensor(0));
  builder.mote(4, air, sensor(3'842'000));
  builder.mote(3, air, sensor(6'940'000));
  return builder.done();
}

// Paper: In-Hospital Transport Test-Bed. Ten anchors, six PIR motes and the robot's mote. The sink
// has seven input channels, so it is built with more of them than the four of Table 1 (decision
// 129).
Network hospital(const ScenarioOptions& options) {
  constexpr std::uint16_t kRobotId = 2;
  constexpr std::uint16_t kMotes = 7;
  constexpr std::uint8_t kAnchors = 10;
  Builder builder(options);
  const std::size_t air = builder.radio("rA");
  Script sink{.time_step_ticks = 500};
  for (std::uint16_t i = 0; i < kMotes; ++i) {
    const std::uint16_t id = static_cast<std::uint16_t>(kRobotId + i);
    const std::uint8_t size = id == kRobotId ? kAnchors : 1;
    sink.channels.push_back({machine::Direction::kIn, {kIsland, id}, size, {}});
  }
  builder.island('A', kIsland, air, std::move(sink));
  for (std::uint16_t i = 0; i < kMotes; ++i) {
    const std::uint16_t id = static_cast<std::uint16_t>(kRobotId + i);
    Script script = joining(i * us_of(200), id == kRobotId ? kRobot : kPirMote);
    const std::uint8_t size = id == kRobotId ? kAnchors : 1;
    script.channels.push_back({machine::Direction::kOut, {kLocalPid, kSinkId}, size, {}});
    script.time_step_ticks = 500;
    builder.mote(id, air, std::move(script));
  }
  for (std::uint8_t anchor = 1; anchor <= kAnchors; ++anchor) builder.anchor(air, anchor);
  Network network = builder.done();
  network.nodes.front().config.profile.channels_max = machine::kChannelsRoom;
  return network;
}

// Paper: the AAL test-bed. Twelve motes of a home and a bracelet. The bracelet goes out of reach
// and comes back; one mote's battery is changed, and its sink, which still lists it, does not take
// it again (J2-LISTED, decision 105); another fails for good.
Network home(const ScenarioOptions& options) {
  constexpr std::uint16_t kFirst = 2;
  constexpr std::uint16_t kMotes = 12;
  constexpr std::uint16_t kBracelet = 20;
  Builder builder(options);
  const std::size_t air = builder.radio("rA");
  builder.island('A', kIsland, air);
  for (std::uint16_t i = 0; i < kMotes; ++i) {
    Script script = joining(i * us_of(150), kStandard);
    script.sends.push_back(updates(kLight | kTemp | kHumid, us_of(2000)));
    if (i == 4) script.cuts.push_back({us_of(6000), us_of(2000), false});
    if (i == 7) script.cuts.push_back({us_of(9000), -1, false});
    builder.mote(static_cast<std::uint16_t>(kFirst + i), air, std::move(script));
  }
  Script bracelet = joining(us_of(3000), kPirMote);
  bracelet.sends.push_back(updates(kPir));
  bracelet.cuts.push_back({us_of(7000), us_of(4000), true});
  builder.mote(kBracelet, air, std::move(bracelet));
  return builder.done();
}

// Paper: Message Dispatcher. The PC makes a mote open a door.
Network open_door(const ScenarioOptions& options) {
  constexpr std::uint16_t kDoorId = 4;
  Builder builder(options);
  const std::size_t air = builder.radio("rA");
  Script pc;
  pc.sends.push_back(reliable({kIsland, kDoorId}, "OPEN_DOOR", us_of(2000), us_of(2000)));
  builder.island('A', kIsland, air, {}, std::move(pc));
  builder.mote(kDoorId, air, joining(0, kDoor));
  return builder.done();
}

// Paper: The Inter-Island Connectivity. Mote, sink and PC of each island to those of the other.
Network inter_island(const ScenarioOptions& options) {
  Builder builder(options);
  const std::uint16_t islands[] = {kIsland, kOtherIsland};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint16_t there = islands[1 - i];
    const auto mote_id = static_cast<std::uint16_t>(2 + i);
    const auto mote_there = static_cast<std::uint16_t>(3 - i);
    const char letter = "AB"[i];
    const auto at = [&](int ms) {
      return us_of(static_cast<machine::Ticks>(ms)) + static_cast<Micros>(i) * us_of(50);
    };
    const std::size_t air = builder.radio(std::string("r") + letter);
    Script sink;
    sink.sends = {reliable({there, mote_there}, "sink to mote", at(2000), us_of(2000)),
                  reliable({there, kSinkId}, "sink to sink", at(2200), us_of(2000)),
                  reliable({there, kNullDevid}, "sink to PC", at(2400), us_of(2000))};
    Script pc{.sends = {reliable({there, mote_there}, "PC to mote", at(2600), us_of(2000)),
                        reliable({there, kNullDevid}, "PC to PC", at(2800), us_of(2000)),
                        reliable({kLocalPid, mote_id}, "PC to own mote", at(3000), us_of(2000))}};
    builder.island(letter, islands[i], air, std::move(sink), std::move(pc));
    Script mote = joining(0, kStandard);
    mote.sends = {reliable({there, mote_there}, "mote to mote", at(1000), us_of(2000)),
                  reliable({there, kSinkId}, "mote to sink", at(1200), us_of(2000)),
                  reliable({there, kNullDevid}, "mote to PC", at(1400), us_of(2000)),
                  reliable({kLocalPid, kNullDevid}, "mote to own PC", at(1600), us_of(2000))};
    builder.mote(mote_id, air, std::move(mote));
  }
  return builder.done();
}

// Any number of motes in range of any number of sinks; every mote chooses one.
Network free_network(const ScenarioOptions& options) {
  Builder builder(options);
  const std::size_t air = builder.radio("rA");
  for (std::size_t i = 0; i < options.sinks; ++i) {
    builder.island(static_cast<char>('A' + i), static_cast<std::uint16_t>(kIsland + i), air);
  }
  for (std::size_t i = 0; i < options.motes; ++i) {
    const auto join_us = static_cast<Micros>(i) * 137 * kBinaryMsUs;
    builder.mote(static_cast<std::uint16_t>(2 + i), air, sensor(join_us));
  }
  return builder.done();
}

// Paper: Island Collision Resolution and Safe Join.
Network two_sinks(const ScenarioOptions& options) {
  ScenarioOptions one_mote = options;
  one_mote.motes = 1;
  one_mote.sinks = 2;
  return free_network(one_mote);
}

constexpr Scenario kScenarios[] = {
    {"timeline", "three motes join one after the other, then report every 500 ms", 12'000'000},
    {"hospital", "ten RSSI anchors, six PIR motes and a robot with synaptic channels", 10'000'000},
    {"home", "twelve motes and a bracelet; they join, leave and come back", 16'000'000},
    {"open_door", "the PC has a mote open a door, reliably", 8'000'000},
    {"inter_island", "motes, sinks and PCs of two islands, in every direction", 8'000'000},
    {"two_sinks", "one mote in range of two sinks", 6'000'000},
    {"free", "--motes motes and --sinks sinks, all in range of one another", 10'000'000},
};

}  // namespace

std::span<const Scenario> scenarios() { return kScenarios; }

const Scenario* find_scenario(std::string_view name) {
  for (const Scenario& scenario : kScenarios) {
    if (name == scenario.name) return &scenario;
  }
  return nullptr;
}

Network make_network(const Scenario& scenario, const ScenarioOptions& options) {
  constexpr Network (*kMakers[])(const ScenarioOptions&) = {
      timeline, hospital, home, open_door, inter_island, two_sinks, free_network};
  static_assert(std::size(kMakers) == std::size(kScenarios));
  const std::ptrdiff_t index = &scenario - kScenarios;
  assert(index >= 0 && static_cast<std::size_t>(index) < std::size(kMakers));
  return kMakers[index](options);
}

}  // namespace rubric::simulate
