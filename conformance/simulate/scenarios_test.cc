// The paper's scenarios as a whole, and the readability of their captures and logs.
#include "conformance/simulate/scenarios.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/frame.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/simulation.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::simulate {
namespace {

struct Outcome {
  Statistics statistics;
  std::string rtr;
  std::string pcapng;
  trace::File log;
  std::vector<machine::State> states;
};

Outcome run(const char* name, const ScenarioOptions& options = {}) {
  const Scenario* const scenario = find_scenario(name);
  EXPECT_NE(scenario, nullptr);
  Network network = make_network(*scenario, options);
  CaptureRecorder capture(network);
  TraceRecorder log(network, name);
  Simulation simulation(std::move(network), {&capture, &log});
  simulation.run_until(scenario->length_us);
  Outcome result{.statistics = simulation.statistics(), .log = log.file()};
  result.rtr = trace::print(result.log);
  result.pcapng = capture.finish();
  for (NodeId i = 0; i < simulation.network().nodes.size(); ++i) {
    result.states.push_back(simulation.state(i));
  }
  return result;
}

// Returns the lines of that node, operation and message.
std::vector<const trace::Line*> lines(const Outcome& result, std::string_view node, trace::Op op,
                                      std::string_view message) {
  std::vector<const trace::Line*> found;
  for (const trace::Line* line : result.log.cases.front().lines()) {
    if (line->node == node && line->op == op && line->message.name == message) {
      found.push_back(line);
    }
  }
  return found;
}

// How many packets a reader finds in the capture, and how many of them are malformed.
struct Decoded {
  std::size_t packets = 0;
  std::size_t malformed = 0;
  std::vector<std::string> interfaces;
};
Decoded decoded(const std::string& pcapng) {
  Decoded result;
  const auto reader = make_reader(InputFormat::kPcapng);
  const reflect::FrameDecoder decoder(rubicon::tables::kProtocol);
  reflect::Frame frame;
  std::int64_t last_ns = 0;
  auto count = [&](const Packet& packet) {
    ++result.packets;
    decoder.decode(packet, frame);
    if (frame.malformed() || packet.error.fault != Fault::kNone) ++result.malformed;
    EXPECT_GE(packet.time_ns, last_ns);
    last_ns = packet.time_ns;
  };
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(pcapng.data()), pcapng.size());
  reader->feed(bytes, count);
  reader->finish(count);
  for (const Interface& one : reader->interfaces()) result.interfaces.push_back(one.name);
  return result;
}

class EveryScenario : public testing::TestWithParam<const char*> {};

TEST_P(EveryScenario, LogParsesAndPrintsTheSame) {
  const Outcome once = run(GetParam());
  const trace::Parsed parsed = trace::parse(once.rtr, "run.rtr");
  EXPECT_TRUE(parsed.ok()) << parsed.errors();
  EXPECT_EQ(parsed.file, once.log);
  EXPECT_EQ(trace::print(parsed.file), once.rtr);
  std::size_t emitted = 0;
  for (const trace::Line* line : once.log.cases.front().lines()) {
    if (line->op != trace::Op::kEmits) continue;
    ++emitted;
    EXPECT_EQ(line->requirements.size(), 1U) << trace::print(*line);
  }
  EXPECT_GT(emitted, 10U);
}

TEST_P(EveryScenario, CaptureDecodesWithNothingMalformed) {
  for (const double faults : {0.0, 0.1}) {
    const Outcome once = run(GetParam(), {.seed = 3, .loss = faults, .duplication = faults});
    const Decoded all = decoded(once.pcapng);
    EXPECT_EQ(all.malformed, 0U);
    const Statistics& s = once.statistics;
    EXPECT_EQ(all.packets, s.radio_frames + s.link_acks + s.serial_frames);
  }
}

TEST_P(EveryScenario, SeedReplaysByteForByte) {
  const ScenarioOptions options{.seed = 11, .loss = 0.05, .duplication = 0.05};
  const Outcome first = run(GetParam(), options);
  const Outcome again = run(GetParam(), options);
  EXPECT_EQ(first.rtr, again.rtr);
  EXPECT_EQ(first.pcapng, again.pcapng);
  EXPECT_TRUE(first.statistics == again.statistics);
  EXPECT_NE(run(GetParam(), {.seed = 12, .loss = 0.05, .duplication = 0.05}).pcapng, first.pcapng);
}

TEST_P(EveryScenario, EveryReliableMessageEndsOnce) {
  const Outcome once = run(GetParam(), {.seed = 5, .loss = 0.2, .duplication = 0.2});
  std::set<std::pair<std::string, std::string>> ended;
  for (const trace::Line* line : once.log.cases.front().lines()) {
    if (line->message.name != "ack_received") continue;
    const std::string seq = std::to_string(line->message.find("seq_num")->number);
    EXPECT_TRUE(ended.emplace(line->node, seq).second) << line->node << ' ' << seq;  // T3-ONCE
  }
  EXPECT_EQ(ended.size(), once.statistics.acks + once.statistics.ack_failures);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario,
                         testing::Values("timeline", "hospital", "home", "open_door",
                                         "inter_island", "two_sinks", "free"),
                         [](const auto& one) { return std::string(one.param); });

TEST(Timeline, JoinsInOrderThenReportsEveryPeriod) {
  const Outcome once = run("timeline");
  const std::vector<std::pair<std::string, std::int64_t>> motes = {
      {"m2", 0}, {"m4", 3842}, {"m3", 6940}};
  std::uint64_t reports = 0;
  for (const auto& [mote, join_ms] : motes) {
    const auto requests = lines(once, mote, trace::Op::kEmits, "join_request");
    ASSERT_EQ(requests.size(), 1U);
    EXPECT_EQ(requests[0]->time.from, ticks_of(join_ms * 1000));
    EXPECT_EQ(lines(once, mote, trace::Op::kEmits, "joined").size(), 1U);
    const auto sends = lines(once, mote, trace::Op::kGiven, "send");
    for (std::size_t i = 1; i < sends.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(sends[i]->time.from - sends[i - 1]->time.from), 500, 1);
    }
    reports += sends.size();
  }
  // 12 s are 12288 ticks: 24, 16 and 10 periods are left after the joins.
  EXPECT_EQ(reports, 24U + 16 + 10);
  const auto arrived = lines(once, "bA", trace::Op::kEmits, "received");
  EXPECT_EQ(arrived.size(), reports + motes.size());  // And a serial_joined each.
  EXPECT_EQ(decoded(once.pcapng).interfaces, (std::vector<std::string>{"radio", "serial:1"}));
}

TEST(Hospital, ReliableChannelsBringNewDataEachTick) {
  const Outcome once = run("hospital");
  const Statistics& s = once.statistics;
  EXPECT_EQ(s.joins, 7U);
  // The sink states eight channels (decision 129): the robot's and six more bring their data.
  EXPECT_NE(once.rtr.find("%node sA sink id=1 island=11 channels=8 iut\n"), std::string::npos);
  EXPECT_EQ(once.states[0].synaptic.in.size(), 7U);
  EXPECT_EQ(once.states[0].synaptic.in[0].size, 10);
  EXPECT_TRUE(lines(once, "sA", trace::Op::kEmits, "channel_result").size() == 7U);
  std::set<std::string> fresh;
  for (const trace::Line* line : lines(once, "sA", trace::Op::kEmits, "syn_data")) {
    const trace::Message& message = line->message;
    if (*message.find("status") != trace::Value::names("new")) continue;
    fresh.insert(trace::print(message));
  }
  EXPECT_EQ(fresh.size(), 7U);
  EXPECT_GT(s.synaptic_new, 105U);
  EXPECT_LT(s.synaptic_old, s.synaptic_new / 5);
  EXPECT_EQ(s.synaptic_unknown, 0U);
  // Ten anchors, twice a second, for ten seconds; the robot misses few.
  const auto beacons = lines(once, "m2", trace::Op::kGiven, "rssi_beacon");
  EXPECT_GT(beacons.size(), 190U);
  EXPECT_LE(beacons.size(), 210U);
}

TEST(Home, ThirteenJoinAndOneIsLeftOutAfterItsReboot) {
  const Outcome once = run("home");
  EXPECT_EQ(once.statistics.joins, 13U);
  EXPECT_EQ(once.states[0].sink.members.size(), 13U);
  EXPECT_EQ(lines(once, "m6", trace::Op::kGiven, "off").size(), 1U);
  EXPECT_EQ(lines(once, "m6", trace::Op::kGiven, "reboot").size(), 1U);
  const auto ends = lines(once, "m6", trace::Op::kEmits, "joined");
  ASSERT_GE(ends.size(), 2U);
  EXPECT_EQ(*ends[0]->message.find("result"), trace::Value::names("success"));
  EXPECT_EQ(*ends[1]->message.find("result"), trace::Value::names("fail"));
  // The bracelet is silent while it is away, and continues when it is back.
  std::set<std::int64_t> seconds;
  for (const trace::Line* line : lines(once, "m20", trace::Op::kEmits, "net_msg")) {
    seconds.insert(line->time.from / 1024);
  }
  EXPECT_TRUE(seconds.count(5) == 1 && seconds.count(8) == 0 && seconds.count(13) == 1);
  // The mote that fails for good is not heard again.
  const auto off = lines(once, "m9", trace::Op::kGiven, "off");
  ASSERT_EQ(off.size(), 1U);
  EXPECT_EQ(off[0]->time.from, 9000);
  EXPECT_TRUE(lines(once, "m9", trace::Op::kGiven, "reboot").empty());
  EXPECT_LE(lines(once, "m9", trace::Op::kEmits, "net_msg").back()->time.from, 9000);
}

TEST(OpenDoor, DeliveredAndAcked) {
  const Outcome once = run("open_door");
  const auto opened = lines(once, "m4", trace::Op::kEmits, "received");
  ASSERT_EQ(opened.size(), 4U);
  EXPECT_EQ(opened[0]->message.find("data")->text, "OPEN_DOOR");
  EXPECT_EQ(lines(once, "bA", trace::Op::kEmits, "ack_received").size(), 4U);
  EXPECT_EQ(once.statistics.acks, 4U);
  EXPECT_EQ(once.statistics.ack_failures, 0U);
}

TEST(InterIsland, EveryDirectionArrivesAndIsAcked) {
  const Outcome once = run("inter_island");
  const Statistics& s = once.statistics;
  EXPECT_EQ(s.joins, 2U);
  EXPECT_GT(s.acks, 60U);
  EXPECT_LE(s.ack_failures, 3U);  // Two of a collision.
  const std::vector<std::pair<std::string, std::vector<std::string>>> expected = {
      {"m2", {"mote to mote", "sink to mote", "PC to mote", "PC to own mote"}},
      {"m3", {"mote to mote", "sink to mote", "PC to mote", "PC to own mote"}},
      {"sA", {"mote to sink", "sink to sink"}},
      {"sB", {"mote to sink", "sink to sink"}},
      {"bA", {"mote to PC", "sink to PC", "PC to PC", "mote to own PC"}},
      {"bB", {"mote to PC", "sink to PC", "PC to PC", "mote to own PC"}}};
  for (const auto& [node, texts] : expected) {
    const auto received = lines(once, node, trace::Op::kEmits, "received");
    for (const std::string& text : texts) {
      EXPECT_GE(std::count_if(received.begin(), received.end(),
                              [&](const trace::Line* line) {
                                return line->message.find("data")->text == text;
                              }),
                2)
          << node << ": " << text;
    }
  }
}

TEST(TwoSinks, TheMoteChoosesOneAndOnlyThatListsIt) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Outcome once = run("two_sinks", {.seed = seed, .loss = 0.1});
    std::size_t listed = 0;
    std::uint16_t island = 0;
    for (const machine::State& state : once.states) {
      if (state.config.role != machine::Role::kSink || state.sink.members.empty()) continue;
      ++listed;
      island = state.island;
    }
    EXPECT_LE(listed, 1U);
    const machine::State& mote = once.states.back();
    if (mote.join.phase != machine::JoinMote::Phase::kMember || listed == 0) continue;
    EXPECT_EQ(mote.join.address.pid, island) << "seed " << seed;
  }
}

TEST(Free, AllJoinThoughManyAreLost) {
  const Outcome once = run("free", {.seed = 2, .loss = 0.05, .motes = 15, .sinks = 1});
  EXPECT_GE(once.statistics.joins, 14U);
  EXPECT_GT(once.statistics.lost, 10U);
  EXPECT_EQ(once.statistics.lost + once.statistics.collided + once.statistics.unheard +
                once.statistics.doubled,
            [&] {
              std::uint64_t faults = 0;
              for (const trace::Line* line : once.log.cases.front().lines()) {
                faults += trace::is_fault(line->op);
              }
              return faults;
            }());
}

TEST(Free, NoSinkNobodyJoins) {
  const Outcome once = run("free", {.motes = 2, .sinks = 0});
  EXPECT_EQ(once.statistics.joins, 0U);
  EXPECT_GE(once.statistics.join_failures, 2U);
}

}  // namespace
}  // namespace rubric::simulate
