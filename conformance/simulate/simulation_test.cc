// The lines of simulated networks: timing, collisions, faults, and exact replay.
#include "conformance/simulate/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "conformance/simulate/script.h"

namespace rubric::simulate {
namespace {

using machine::Role;

constexpr std::uint8_t kControl = 10;

// Keeps everything that a recorder gets, as text, and times of frames.
class Notes final : public Recorder {
 public:
  struct OnAir {
    Micros time_us;
    std::vector<std::uint8_t> bytes;
  };
  void given(Micros time_us, NodeId node, const machine::Event& event) override {
    if (std::holds_alternative<machine::Heard>(event)) heard_us.push_back({node, time_us});
    text += std::to_string(time_us) + '<' + std::to_string(node) + ' ' +
            std::to_string(event.index()) + '\n';
  }
  void did(Micros time_us, NodeId node, const machine::Actions& actions) override {
    for (const machine::Action& action : actions.all()) {
      text += std::to_string(time_us) + '>' + std::to_string(node) + ' ' +
              std::to_string(static_cast<int>(action.requirement)) + '\n';
    }
  }
  void mishap(Micros, NodeId node, Mishap what, const machine::Frame&) override {
    mishaps.push_back({node, what});
  }
  void link_ack(Micros, NodeId, bool acked) override { link_acks.push_back(acked); }
  void on_air(Micros time_us, std::size_t, Bytes frame) override {
    air.push_back({time_us, {frame.begin(), frame.end()}});
  }
  void on_serial(Micros time_us, std::size_t, bool to_sink, const SerialFrame& frame) override {
    serial.push_back({time_us, to_sink, frame.kind, frame.seq, frame.packet.size()});
  }

  struct OnSerial {
    Micros time_us;
    bool to_sink;
    std::uint8_t kind;
    std::int32_t seq;
    std::size_t packet_bytes;
  };
  std::string text;
  std::vector<std::pair<NodeId, Micros>> heard_us;
  std::vector<std::pair<NodeId, Mishap>> mishaps;
  std::vector<bool> link_acks;
  std::vector<OnAir> air;
  std::vector<OnSerial> serial;
};

NodePlan node(std::string name, Role role, std::uint16_t id, std::uint16_t island, Script script) {
  NodePlan plan{.name = std::move(name)};
  plan.config.role = role;
  plan.config.id = id;
  plan.config.island = island;
  plan.application = std::make_unique<ScriptedApplication>(std::move(script));
  return plan;
}

ScriptedSend once(machine::Address dest, bool reliable, Micros at_us) {
  return {
      .dest = dest, .app_id = kControl, .reliable = reliable, .data = {1, 2, 3}, .first_us = at_us};
}

// Sink 0, base station 1, then motes 2, 3, ...; each mote joins at once.
Network island(std::vector<Script> motes, Script base_station = {}) {
  Network network;
  network.radios.push_back({.name = "rA", .faults = {}, .deaf = {}, .link_faults = {}});
  network.nodes.push_back(node("sA", Role::kSink, 1, 11, {}));
  network.nodes.push_back(node("bA", Role::kBaseStation, 0, 11, std::move(base_station)));
  network.serials.push_back({.name = "serA", .sink = 0, .base_station = 1, .loss = 0});
  std::uint16_t id = 2;
  for (Script& script : motes) {
    script.join_us = (id - 2) * 100'000;
    network.nodes.push_back(node("m" + std::to_string(id), Role::kMote, id, 0, std::move(script)));
    ++id;
  }
  return network;
}

Script sending(ScriptedSend send) {
  Script script;
  script.sends.push_back(std::move(send));
  return script;
}

TEST(EventQueue, TimeThenOrderOfAsking) {
  EventQueue queue;
  std::string order;
  queue.at(20, [&] { order += 'c'; });
  queue.at(10, [&] {
    order += 'a';
    queue.at(5, [&] { order += 'b'; });  // In the past: now.
  });
  queue.at(20, [&] { order += 'd'; });
  queue.at(31, [&] { order += 'x'; });
  queue.run_until(30);
  EXPECT_EQ(order, "abcd");
  EXPECT_EQ(queue.now(), 30);
}

TEST(Random, BoundsAreReachedAndKept) {
  Random random(3);
  std::vector<int> seen(4);
  for (int i = 0; i < 1000; ++i) ++seen.at(static_cast<std::size_t>(random.between(0, 3)));
  EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 200);
  EXPECT_FALSE(random.chance(0));
  EXPECT_TRUE(random.chance(1));
}

TEST(Radio, FramesAsOnTheAirAndWithTheirTiming) {
  Notes notes;
  Simulation simulation(island({Script{}}), {&notes});
  simulation.run_until(300'000);
  ASSERT_EQ(notes.air.size(), 4U);  // Request, reply, ack_join, link ack.
  const std::vector<std::uint8_t>& request = notes.air[0].bytes;
  EXPECT_EQ(request.size(), 17U);
  const std::vector<std::uint8_t> header = {0x41, 0x88, 0, 0x22, 0, 1, 0, 2, 0, 0x3F, 14};
  EXPECT_TRUE(std::equal(header.begin(), header.end(), request.begin()));
  // The sink has it (6 + 17 + 2) * 32 us later.
  ASSERT_FALSE(notes.heard_us.empty());
  EXPECT_EQ(notes.heard_us[0], std::pair(NodeId{0}, notes.air[0].time_us + 800));
  EXPECT_EQ(notes.air[2].bytes[0], 0x61);  // ack_join asks for a link ack,
  EXPECT_EQ(notes.air[2].bytes[2], 1);     // and is the mote's second frame.
  EXPECT_EQ(notes.air[3].bytes, (std::vector<std::uint8_t>{0x02, 0x00, 1}));
  const Micros wait = notes.air[3].time_us - (notes.air[2].time_us + 33 * 32);
  EXPECT_GE(wait, 192);
  EXPECT_LE(wait, 2'500);
  EXPECT_EQ(notes.link_acks, std::vector<bool>{true});
}

TEST(Radio, CollisionDestroysBothAtTheReceiverInTheMiddle) {
  // Motes 2 and 3 do not hear one another, so listening first does not help.
  Script chatty = sending(once({11, 1}, false, 1'000'000));
  chatty.sends.front().period_us = 2'000;
  Network network = island({chatty, chatty});
  network.nodes[3].application = std::make_unique<ScriptedApplication>([&] {
    Script script = chatty;
    script.join_us = 0;
    return script;
  }());
  network.radios[0].deaf = {{2, 3}, {3, 2}};
  Notes notes;
  Simulation hidden(std::move(network), {&notes});
  hidden.run_until(6'000'000);
  EXPECT_GT(hidden.statistics().collided, 50U);
  EXPECT_EQ(std::count_if(notes.mishaps.begin(), notes.mishaps.end(),
                          [](const auto& m) { return m.second == Mishap::kCollided; }),
            static_cast<std::ptrdiff_t>(hidden.statistics().collided));

  Simulation open(island({chatty, chatty}), {});
  open.run_until(6'000'000);
  EXPECT_LT(open.statistics().collided, hidden.statistics().collided / 3);
}

TEST(Radio, OutOfRangeNobodyAnswers) {
  Network network = island({Script{}});
  network.radios[0].deaf = {{2, 0}};
  Simulation simulation(std::move(network));
  simulation.run_until(3'000'000);
  EXPECT_EQ(simulation.statistics().joins, 0U);
  EXPECT_EQ(simulation.statistics().join_failures, 1U);
  EXPECT_EQ(simulation.statistics().radio_frames, 5U);  // The requests of one call (J8-LIMIT).
}

TEST(Radio, LossOfOneLinkOnly) {
  Script talk = sending(once({11, 1}, false, 500'000));
  talk.sends.front().period_us = 50'000;
  Network network = island({talk, talk});
  network.radios[0].link_faults.push_back({2, 0, {}});
  network.radios[0].faults.loss = 0.5;  // Everybody else's.
  Notes notes;
  Simulation simulation(std::move(network), {&notes});
  simulation.run_until(10'000'000);
  EXPECT_GT(simulation.statistics().lost, 50U);
  EXPECT_EQ(simulation.statistics().joins, 2U);
  // From mote 2 to the sink nothing was lost: the sink missed only frames of mote 3, about half.
  const auto lost_at_sink =
      std::count(notes.mishaps.begin(), notes.mishaps.end(), std::pair(NodeId{0}, Mishap::kLost));
  EXPECT_GT(lost_at_sink, 50);
  EXPECT_LT(lost_at_sink, 140);
}

TEST(Radio, DuplicatesArriveAndCount) {
  Network network = island({sending(once({11, 1}, true, 500'000))});
  network.radios[0].faults.duplication = 1;
  Simulation simulation(std::move(network));
  simulation.run_until(3'000'000);
  const Statistics& s = simulation.statistics();
  EXPECT_EQ(s.joins, 1U);
  EXPECT_GE(s.doubled, 5U);
  EXPECT_EQ(s.acks, 1U);      // T3-ONCE
  EXPECT_EQ(s.received, 3U);  // serial_joined once (J6-REPEAT), the message each time (T2-ONCE).
}

// A sniffer sees the receivers' frames: every frame of a sender twice in a row, byte for byte.
TEST(Radio, DuplicatesAreOnTheAir) {
  Network network = island({sending(once({11, 1}, true, 500'000))});
  network.radios[0].faults.duplication = 1;
  Notes notes;
  Simulation simulation(std::move(network), {&notes});
  simulation.run_until(3'000'000);
  std::size_t frames = 0;
  for (const int sender : {1, 2}) {
    std::vector<Notes::OnAir> sent;
    for (const Notes::OnAir& frame : notes.air) {
      const bool is_link_ack = frame.bytes.size() == 3;
      if (!is_link_ack && frame.bytes[7] == sender) sent.push_back(frame);
    }
    ASSERT_GE(sent.size(), 4U);
    ASSERT_EQ(sent.size() % 2, 0U);
    for (std::size_t i = 0; i < sent.size(); i += 2) {
      EXPECT_EQ(sent[i].bytes, sent[i + 1].bytes) << i;
      const Micros apart_us = sent[i + 1].time_us - sent[i].time_us;
      EXPECT_GT(apart_us, air_us(sent[i].bytes.size()));
      EXPECT_LT(apart_us, 50'000);
      EXPECT_EQ(sent[i].bytes[2], i / 2);  // The DSN.
    }
    frames += sent.size();
  }
  EXPECT_EQ(simulation.statistics().radio_frames, frames);
}

TEST(Radio, DelayIsWithinItsBound) {
  Network network = island({Script{}});
  network.radios[0].faults.delay_max_us = 40'000;
  Notes notes;
  Simulation simulation(std::move(network), {&notes});
  simulation.run_until(2'000'000);
  const Micros delay = notes.heard_us.at(0).second - notes.air.at(0).time_us - 800;
  EXPECT_GT(delay, 0);
  EXPECT_LE(delay, 40'000);
  EXPECT_EQ(simulation.statistics().joins, 1U);
}

TEST(Radio, SwitchedOffHearsAndConfirmsNothing) {
  Script off;
  off.cuts.push_back({500'000, -1, true});
  Script talk = sending(once({11, 2}, true, 1'000'000));
  Simulation simulation(island({off, talk}));
  simulation.run_until(4'000'000);
  EXPECT_EQ(simulation.statistics().unheard, 1U);
  EXPECT_EQ(simulation.statistics().ack_failures, 1U);
}

TEST(Serial, LongFrameTakesElevenMilliseconds) {
  Notes notes;
  Simulation simulation(island({sending(once({11, 0xFFFD}, false, 1'000'000))}), {&notes});
  simulation.run_until(2'000'000);
  ASSERT_EQ(notes.serial.size(), 2U);  // serial_joined, and the message.
  for (const Notes::OnSerial& frame : notes.serial) {
    EXPECT_FALSE(frame.to_sink);
    EXPECT_EQ(frame.kind, 0x45);
    EXPECT_EQ(frame.seq, -1);
    EXPECT_EQ(frame.packet_bytes, 122U);
  }
  const Micros arrived = notes.heard_us.back().second;
  const Micros left = notes.heard_us.at(notes.heard_us.size() - 2).second;
  EXPECT_GE(arrived - left, 11'000);
  EXPECT_LE(arrived - left, 11'300);
}

TEST(Serial, HostFramesAreConfirmedAndRepeatedWhenLost) {
  Notes notes;
  Simulation good(island({Script{}}, sending(once({11, 2}, true, 1'000'000))), {&notes});
  good.run_until(3'000'000);
  const auto host = std::find_if(notes.serial.begin(), notes.serial.end(),
                                 [](const auto& frame) { return frame.to_sink; });
  ASSERT_NE(host, notes.serial.end());
  EXPECT_EQ(host->kind, 0x44);
  EXPECT_EQ(host->seq, 0);
  ASSERT_NE(host + 1, notes.serial.end());
  EXPECT_EQ((host + 1)->kind, 0x43);
  EXPECT_EQ((host + 1)->seq, 0);
  EXPECT_EQ((host + 1)->time_us - host->time_us, 521);  // Six bytes.
  EXPECT_EQ(good.statistics().acks, 1U);

  Network network = island({Script{}}, sending(once({11, 2}, false, 1'000'000)));
  network.serials[0].loss = 0.5;
  network.seed = 5;
  Notes lossy;
  Simulation bad(std::move(network), {&lossy});
  bad.run_until(30'000'000);
  const auto tries = std::count_if(lossy.serial.begin(), lossy.serial.end(),
                                   [](const auto& frame) { return frame.to_sink; });
  EXPECT_GT(tries, 1);
  EXPECT_GE(bad.statistics().received, 1U);  // In the end it came through.
}

TEST(Replay, SameSeedSameRunOtherSeedAnother) {
  const auto run = [](std::uint64_t seed) {
    Script talk = sending(once({11, 1}, true, 500'000));
    talk.sends.front().period_us = 200'000;
    talk.cuts.push_back({3'000'000, 500'000, false});
    Network network = island({talk, talk, talk});
    network.seed = seed;
    network.radios[0].faults = {0.1, 0.1, 5'000};
    Notes notes;
    Simulation simulation(std::move(network), {&notes});
    simulation.run_until(6'000'000);
    return notes.text;
  };
  const std::string first = run(7);
  EXPECT_GT(first.size(), 5'000U);
  EXPECT_EQ(run(7), first);
  EXPECT_NE(run(8), first);
}

TEST(Power, RebootLosesMembershipAndItsSinkStillListsIt) {
  Script script;
  script.cuts.push_back({1'000'000, 200'000, false});
  Simulation simulation(island({script}));
  simulation.run_until(6'000'000);
  EXPECT_EQ(simulation.statistics().joins, 1U);
  EXPECT_GE(simulation.statistics().join_failures, 1U);  // J2-LISTED, decision 105.
  EXPECT_NE(simulation.state(2).join.phase, machine::JoinMote::Phase::kMember);
}

}  // namespace
}  // namespace rubric::simulate
