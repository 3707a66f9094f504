// Logs beside captures, or beside each other, whose clocks are others, or that have none.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"
#include "conformance/trace/print.h"

namespace rubric::check {
namespace {

// The capture of a network, and the lines of its applications in ticks.
struct Recorded {
  std::string capture;
  std::string log;
};

// Returns the capture, and what the applications and the nodes of the network did.
Recorded all_of(const std::string& scenario, std::int64_t length_us = 0) {
  const simulate::Scenario& network = *simulate::find_scenario(scenario);
  simulate::Network made = simulate::make_network(network, {});
  simulate::CaptureRecorder capture(made);
  simulate::TraceRecorder trace(made, network.name);
  simulate::Simulation simulation(std::move(made), {&capture, &trace});
  simulation.run_until(length_us == 0 ? network.length_us : length_us);
  return {capture.finish(), trace::print(trace.file())};
}

Recorded recorded(const std::string& scenario, std::int64_t length_us = 0) {
  const Recorded all = all_of(scenario, length_us);
  Recorded out{all.capture, {}};
  const std::regex other(R"(\s*@\d+\s+\S+\s+[<>]\s+(?!\s|app|power).*)");
  std::istringstream lines(all.log);
  for (std::string line; std::getline(lines, line);) {
    if (!std::regex_match(line, other)) out.log += line + "\n";
  }
  return out;
}

// Returns the log with other times, where `of` says so; a line is dropped where that is negative.
std::string retimed(const std::string& log,
                    const std::function<int(int tick, const std::string& line)>& of) {
  const std::regex timed(R"((\s*@)(\d+)(.*))");
  std::string out;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    std::smatch parts;
    if (std::regex_match(line, parts, timed)) {
      const int tick = of(std::stoi(parts[2]), line);
      if (tick < 0) continue;
      line = parts[1].str() + std::to_string(tick) + parts[3].str();
    }
    out += line + "\n";
  }
  return out;
}

Run read_both(const Recorded& from, bool stamps = true) {
  RunReader reader;
  const std::uint32_t file = reader.open("capture");
  const std::unique_ptr<Reader> packets = make_reader(InputFormat::kPcapng, {});
  auto take = [&](const Packet& packet) {
    Packet one = packet;
    if (!stamps) one.time_ns = kNoTime;
    reader.take(file, one, packets->interfaces()[packet.interface_id].name);
  };
  packets->feed(
      Bytes(reinterpret_cast<const std::uint8_t*>(from.capture.data()), from.capture.size()),
      PacketSink(take));
  packets->finish(PacketSink(take));
  std::string error;
  EXPECT_TRUE(reader.add_bytes("log", from.log, error)) << error;
  return reader.finish();
}

Report judged(const Recorded& from, bool stamps = true) {
  Options options;
  options.sniffer_complete = options.start_cold = true;
  return judge(read_both(from, stamps), options);
}

TEST(AlignLogs, NobodyIsBlamedForTheClockOfALog) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    const Recorded run = recorded(scenario);
    const Report exact = judged(run);
    EXPECT_EQ(broken_in(exact), "") << scenario;
    for (const int ticks : {1, 2, 20, 200, 3000}) {
      const auto later = [&](int tick, const std::string&) { return tick + ticks; };
      const Report report = judged({run.capture, retimed(run.log, later)});
      EXPECT_EQ(broken_in(report), "") << scenario << " " << ticks;
      EXPECT_EQ(report.verdict, exact.verdict) << scenario << " " << ticks;
      EXPECT_EQ(report.exercised, exact.exercised) << scenario << " " << ticks;
    }
  }
}

TEST(AlignLogs, NobodyIsBlamedForItsDrift) {
  const Recorded run = recorded("timeline", 300'000'000);
  for (const int ppm : {-200, 50}) {
    const auto drifted = [&](int tick, const std::string&) {
      return tick + 400 + static_cast<int>(std::int64_t{tick} * ppm / 1'000'000);
    };
    EXPECT_EQ(broken_in(judged({run.capture, retimed(run.log, drifted)})), "") << ppm;
  }
}

TEST(AlignLogs, WhatIsTooEarlyByAnyClockIsFound) {
  const Recorded run = recorded("timeline");
  for (const int ticks : {0, 300}) {
    const auto early = [&](int tick, const std::string& line) {
      const bool it = line.find("m3") != line.npos && line.find("joined(") != line.npos;
      return tick + ticks - (it ? 9 : 0);
    };
    EXPECT_EQ(broken_in(judged({run.capture, retimed(run.log, early)})), "J5-ACCEPT") << ticks;
  }
}

TEST(AlignLogs, TooFewEventsBlameNobody) {
  const Recorded run = recorded("timeline");
  for (const int ticks : {9, 300}) {
    const auto one = [&](int tick, const std::string& line) {
      const bool it = line.find("m3") != line.npos && line.find("joined(") != line.npos;
      return it ? tick - ticks : -1;
    };
    const Report report = judged({run.capture, retimed(run.log, one)});
    EXPECT_EQ(broken_in(report), "") << ticks;
    EXPECT_EQ(report.verdict, Verdict::kInconclusive) << ticks;
  }
}

TEST(AlignLogs, NobodyIsBlamedBesideACaptureWithoutStamps) {
  for (const char* scenario : {"timeline", "home", "open_door", "two_sinks"}) {
    EXPECT_EQ(broken_in(judged(recorded(scenario), false)), "") << scenario;
  }
}

// Judges the log of a network as if each of its nodes had kept one, begun `apart` ticks before that
// of the node before it.
Report judged_apart(const std::string& log, int apart) {
  const std::regex of_a_node(R"((?:%node|\s*@\d+)\s+(\S+).*)");
  std::vector<std::string> names;
  std::map<std::string, std::string> logs;
  std::string head;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    std::smatch parts;
    if (!std::regex_match(line, parts, of_a_node)) {
      if (line[0] == '%' && !line.starts_with("%link")) head += line + "\n";
    } else if (line[0] == '%') {
      names.push_back(parts[1]);
      logs[parts[1]] = line + "\ncase run\n";
    } else {
      logs[parts[1]] += line + "\n";
    }
  }
  RunReader reader;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int ticks = apart * static_cast<int>(i);
    const auto later = [&](int tick, const std::string&) { return tick + ticks; };
    std::string error;
    EXPECT_TRUE(reader.add_bytes(names[i], head + retimed(logs[names[i]], later), error)) << error;
  }
  return judge(reader.finish(), {});
}

TEST(AlignLogs, NobodyIsBlamedWhereEachNodeKeptOne) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    for (const int apart : {0, 3, 300, 1200, 9000}) {
      const Report report = judged_apart(all_of(scenario).log, apart);
      EXPECT_EQ(broken_in(report), "") << scenario << " " << apart;
      EXPECT_EQ(report.verdict, Verdict::kPass) << scenario << " " << apart;
    }
  }
}

TEST(AlignLogs, WhatOneOfThemShowsIsFound) {
  const std::string log = all_of("timeline").log;
  bool done = false;
  const std::string lost = retimed(log, [&](int tick, const std::string& line) {
    const bool it = !done && line.find("bA") != line.npos && line.find("received(") != line.npos;
    done = done || it;
    return it ? -1 : tick;
  });
  ASSERT_TRUE(done);
  for (const int apart : {0, 300, 9000}) {
    EXPECT_EQ(broken_in(judged_apart(lost, apart)), "N8-DELIVER") << apart;
  }
}

}  // namespace
}  // namespace rubric::check
