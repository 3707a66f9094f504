// Recordings as they are made: logs beside captures, or beside each other, whose clocks are others
// or step; captures that miss a part. Nobody is blamed for these, and what is wrong is still found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cstdint>
#include <memory>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/recorded.h"

namespace rubric::check {
namespace {

using testing::Contains;
using testing::HasSubstr;

Run read_both(const Recorded& from, bool stamps = true) {
  const auto stamped = [stamps](Packet& packet) {
    if (!stamps) packet.time_ns = kNoTime;
    return 0;
  };
  return read_apart(from.capture, 1, stamped, {from.log});
}

Report judged(const Recorded& from, bool stamps = true) {
  return judge(read_both(from, stamps), complete());
}

// Returns what is broken where `change` changes the packets of a capture, or the ticks of its log.
template <class Change>
std::string broken(const Recorded& run, Change change, const std::vector<std::string>& logs = {}) {
  return broken_in(judge(read_apart(run.capture, 1, change, logs), complete()));
}
template <class Change>
std::string broken_log(const Recorded& run, Change change) {
  return broken_in(judged({run.capture, retimed(run.log, change)}));
}

// Makes stamps up to so many us late.
auto scatters(std::int64_t most_us, std::uint32_t seed) {
  return [most_us, random = std::minstd_rand(seed)](Packet& packet) mutable {
    packet.time_ns += static_cast<std::int64_t>(random()) % most_us * 1000;
    return 0;
  };
}

bool is_radio(const Packet& packet) { return packet.framing == Framing::kRadio; }

// Makes the length of the nth serial packet another one; the bytes are in `changed`.
auto shortens(int nth, std::string& changed) {
  return [nth, &changed, packets = 0](Packet& packet) mutable {
    constexpr std::size_t kLengthOffset = 5;  // Of the header of a serial packet (TEP 113).
    if (is_radio(packet) || ++packets != nth) return 0;
    changed.assign(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
    changed[kLengthOffset] = static_cast<char>(changed[kLengthOffset] - 1);
    packet.bytes = Bytes(reinterpret_cast<const std::uint8_t*>(changed.data()), changed.size());
    return 0;
  };
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

// From the simulator: a sink radiates what it has not confirmed, loses its power, and radiates it
// again when its host repeats it.
TEST(Recordings, ASinkThatStartsAnewMayRadiateAgainWhatIsRepeatedToIt) {
  RunReader reader{AlignOptions{}};
  std::string error;
  ASSERT_TRUE(
      reader.add_file("conformance/check/tests/testdata/repeated_to_two_lives.pcapng", error))
      << error;
  // What waited so long was acked late.
  EXPECT_EQ(broken_in(judge(reader.finish(), complete())), "T2-PROMPT (weak)");
}

TEST(AlignLogs, NobodyIsBlamedForItsDrift) {
  const Recorded run = recorded("timeline", 300'000'000);
  for (const int ppm : {-200, 50}) {
    const auto drifted = [&](int tick, const std::string&) {
      return tick + 400 + static_cast<int>(std::int64_t{tick} * ppm / 1'000'000);
    };
    EXPECT_EQ(broken_log(run, drifted), "") << ppm;
  }
}

TEST(AlignLogs, WhatIsTooEarlyByAnyClockIsFound) {
  const Recorded run = recorded("timeline");
  for (const int ticks : {0, 300}) {
    const auto early = [&](int tick, const std::string& line) {
      const bool it = line.find("m3") != line.npos && line.find("joined(") != line.npos;
      return tick + ticks - (it ? 9 : 0);
    };
    EXPECT_EQ(broken_log(run, early), "J5-ACCEPT") << ticks;
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

bool all_lines(const std::string&) { return true; }
bool no_radio(const std::string& line) {
  const Words words(line);
  return !words.over_a_link() || words[3].size() < 2 || words[3][0] != 'r' ||
         std::isupper(static_cast<unsigned char>(words[3][1])) == 0;
}

// Returns the log of each node, begun `apart` ticks before that of the node before it.
std::vector<std::string> apart_by(std::vector<std::string> logs, int apart) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const int ticks = apart * static_cast<int>(i);
    logs[i] = retimed(logs[i], [ticks](int tick, const std::string&) { return tick + ticks; });
  }
  return logs;
}

// Judges the log of a network as if each of its nodes had kept one.
Report judged_apart(const std::string& log, int apart) {
  RunReader reader;
  std::string error;
  for (const std::string& one : apart_by(log_of_each(log, all_lines), apart)) {
    EXPECT_TRUE(reader.add_bytes("log", one, error)) << error;
  }
  return judge(reader.finish(), {});
}

TEST(AlignLogs, NobodyIsBlamedWhereEachNodeKeptOne) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    for (const int apart : {0, 300, 9000}) {
      const Report report = judged_apart(all_of(scenario).log, apart);
      EXPECT_EQ(broken_in(report), "") << scenario << " " << apart;
      EXPECT_EQ(report.verdict, Verdict::kPass) << scenario << " " << apart;
    }
  }
}

TEST(AlignLogs, WhatOneOfThemShowsIsFound) {
  const std::string log = all_of("timeline").log;
  int deliveries = 0;
  const std::string lost = retimed(log, [&](int tick, const std::string& line) {
    const bool it = line.find("bA") != line.npos && line.find("received(") != line.npos;
    return it && ++deliveries == 3 ? -1 : tick;
  });
  ASSERT_GT(deliveries, 3);
  for (const int apart : {0, 300, 9000}) {
    EXPECT_EQ(broken_in(judged_apart(lost, apart)), "N8-DELIVER") << apart;
  }
}

// A log may end or begin anywhere, while others go on.
TEST(AlignLogs, NobodyIsBlamedForTheEndOfALog) {
  for (const char* scenario : {"timeline", "open_door", "inter_island", "two_sinks"}) {
    const std::vector<std::string> logs = log_of_each(all_of(scenario).log, all_lines);
    for (std::size_t cut = 0; cut < logs.size(); ++cut) {
      for (const bool head : {false, true}) {
        RunReader reader;
        std::string error;
        for (std::size_t i = 0; i < logs.size(); ++i) {
          const auto part = [&](int tick, const std::string&) {
            return i != cut || (tick < 3000) != head ? tick + 900 * static_cast<int>(i) : -1;
          };
          EXPECT_TRUE(reader.add_bytes("log", retimed(logs[i], part), error)) << error;
        }
        const check::Run run = reader.finish();
        EXPECT_EQ(broken_in(judge(run, {})), "") << scenario << " " << cut << " " << head;
        Options cold{.start_cold = !head};
        EXPECT_EQ(broken_in(judge(run, cold)), "") << scenario << " " << cut << " " << head;
      }
    }
  }
}

TEST(AlignLogs, NobodyIsBlamedWhereOneLogBeginsLate) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    const std::string log = all_of(scenario).log;
    for (const int begin : {400, 1000, 2030, 3000, 4000, 5500}) {
      RunReader reader;
      std::string error;
      const auto late = [&](int tick, const std::string&) { return tick < begin ? -1 : tick; };
      EXPECT_TRUE(reader.add_bytes("log", retimed(log, late), error)) << error;
      EXPECT_EQ(broken_in(judge(reader.finish(), {})), "") << scenario << " " << begin;
    }
  }
}

TEST(AlignLogs, NobodyIsBlamedForAClockThatSteps) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island"}) {
    const Recorded run = recorded(scenario);
    for (const int ticks : {3, 12, 30, 205, 5120}) {
      const auto step = [&](int tick, const std::string&) {
        return tick + (tick > 3000 ? ticks : 0);
      };
      EXPECT_EQ(broken_log(run, step), "") << scenario << " " << ticks;
    }
  }
}

TEST(AlignLogs, NobodyIsBlamedForStampsThatScatterOrAreRounded) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    const Recorded run = recorded(scenario);
    for (const std::int64_t most_us : {1000, 3000, 10'000, 20'000}) {
      EXPECT_EQ(broken(run, scatters(most_us, 1), {run.log}), "") << scenario << " " << most_us;
    }
    for (const int ticks : {10, 20}) {
      const auto rounded = [&](int tick, const std::string&) { return tick / ticks * ticks; };
      EXPECT_EQ(broken_log(run, rounded), "") << scenario << " " << ticks;
    }
  }
}

// Of a line that nobody recorded nothing is known.
TEST(AlignLogs, NobodyIsBlamedForALineThatIsNotRecorded) {
  for (const char* scenario : {"timeline", "open_door", "inter_island", "two_sinks"}) {
    const Recorded all = all_of(scenario);
    const auto air = [](Packet& packet) { return packet.framing == Framing::kRadio ? 0 : -1; };
    for (const bool complete : {false, true}) {
      Options options{.sniffer_complete = complete, .start_cold = complete};
      const check::Run applications = read_apart(all.capture, 1, air, {recorded(scenario).log});
      EXPECT_EQ(broken_in(judge(applications, options)), "") << scenario << " " << complete;
      // Both ends of a line may have kept a log of it.
      const check::Run lines =
          read_apart(all.capture, 1, air, apart_by(log_of_each(all.log, no_radio), 700));
      EXPECT_EQ(broken_in(judge(lines, options)), "") << scenario << " " << complete;
    }
  }
}

TEST(AlignLogs, ALogThatSaysSomethingElseThanTheCaptureIsFound) {
  struct Change {
    const char* what;
    const char* with;
    const char* rule;
  };
  const Recorded run = recorded("timeline");
  for (const Change& change : {
           Change{"(m3 +< +app +join\\(type=)\\w+", "$1iris_demo", "J1-REQUEST"},
           Change{" *@\\d+ +m3 +> +app +joined.*\n", "", "J5-SUCCESS"},
           Change{" *@\\d+ +sA +> +app +mote_joined\\(address=11:3.*\n", "", "J6-ADD"},
           Change{"(m4 +< +app +send\\(.*)reliable=0", "$1reliable=1", "N2-ONCE"},
           Change{"(m4 +< +app +send\\(.*data=x..)..", "$1ff", "T1-WRAP"},
       }) {
    const auto first = std::regex_constants::format_first_only;
    const std::string other =
        std::regex_replace(run.log, std::regex(change.what), change.with, first);
    ASSERT_NE(other, run.log) << change.what;
    for (const bool known : {false, true}) {
      const check::Run both = read_both({run.capture, other});
      EXPECT_EQ(broken_in(judge(both, known ? complete() : Options{})), change.rule)
          << change.what << " " << known;
    }
  }
  // Without its call of joinIsland the log may lack what it does not show.
  const std::regex call(" *@\\d+ +m3 +< +app +join.*\n");
  const Report report = judged({run.capture, std::regex_replace(run.log, call, "")});
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].requirement, "J1-CALLED"_rule);
  EXPECT_EQ(report.verdict, Verdict::kInconclusive);
}

// A log whose writer was killed, or begun late, and a capture that begins after the log or ends
// before it.
TEST(AlignLogs, NobodyIsBlamedForWhatAShortLogDoesNotSay) {
  for (const char* scenario : {"open_door", "inter_island", "hospital", "timeline"}) {
    const Recorded run = recorded(scenario);
    for (const int cut : {2500, 4100, 5500, 6000}) {
      const auto head = [&](int tick, const std::string&) { return tick > cut ? -1 : tick; };
      const auto tail = [&](int tick, const std::string&) { return tick < cut ? -1 : tick; };
      EXPECT_EQ(broken_log(run, head), "") << scenario << ", the log until " << cut;
      EXPECT_EQ(broken_log(run, tail), "") << scenario << ", the log from " << cut;
      std::int64_t begin_ns = 0;
      const auto late = [&](Packet& packet) {
        if (begin_ns == 0) begin_ns = packet.time_ns;
        return packet.time_ns - begin_ns < std::int64_t{cut} * 976'562 ? -1 : 0;
      };
      EXPECT_EQ(broken_in(judge(read_apart(run.capture, 1, late, {run.log}), {})), "")
          << scenario << ", the capture from " << cut;
      const auto early = [&](Packet& packet) { return late(packet) < 0 ? 0 : -1; };
      EXPECT_EQ(broken(run, early, {run.log}), "") << scenario << ", the capture until " << cut;
    }
  }
}

// What both cover is judged, and so is what the capture shows alone.
TEST(AlignLogs, WhatAShortLogShowsIsFound) {
  const Recorded run = recorded("timeline");
  const std::regex joined(" *@\\d+ +m3 +> +app +joined.*\n");
  ASSERT_TRUE(std::regex_search(run.log, joined));
  const auto head = [&](int tick, const std::string&) { return tick > 10500 ? -1 : tick; };
  const std::string other = retimed(std::regex_replace(run.log, joined, ""), head);
  EXPECT_EQ(broken_in(judged({run.capture, other})), "J5-SUCCESS");
  std::string changed;
  const auto early = [&](int tick, const std::string&) { return tick > 5000 ? -1 : tick; };
  EXPECT_EQ(broken(run, shortens(20, changed), {retimed(run.log, early)}), "WIRE-AM-LENGTH");
}

// A log whose clock steps is judged on either side of the step, and not across it.
TEST(AlignLogs, ALogWhoseClockStepsForth) {
  const Recorded run = recorded("hospital");
  const auto step = [](int tick, const std::string&) { return tick > 700 ? tick + 3072 : tick; };
  EXPECT_EQ(broken_log(run, step), "");
  const std::string again = run.log + "@10300 m8 > app joined(address=11:8 result=success)\n";
  EXPECT_EQ(broken_in(judged({run.capture, retimed(again, step)})), "J5-ONCE");
}

// Where the log is put too early, each delivery comes before its frame, in one long episode.
TEST(AlignLogs, ADeliveryOfSomethingElseIsFoundAmongManyDeliveries) {
  const Recorded run = recorded("timeline");
  int deliveries = 0;
  const auto again = [&](int tick, const std::string& line) {
    const bool its = line.find("bA") != line.npos && line.find("received(") != line.npos;
    return its && ++deliveries == 6 ? tick : -1;
  };
  const std::string line = retimed(run.log, again);
  std::string log = run.log;
  const std::size_t at = log.find(line.substr(line.find("@")));
  ASSERT_NE(at, log.npos);
  log.replace(log.find("data=x", at), 8, "data=xff");
  EXPECT_EQ(broken_in(judged({run.capture, log})), "T1-DELIVER");
}

TEST(AlignLogs, AJoinThatFailsAtOnceIsFound) {
  const Recorded run = recorded("timeline");
  const std::regex joined("(m2 +> +app +joined\\().*(\\))");
  ASSERT_TRUE(std::regex_search(run.log, joined));
  const std::string other =
      std::regex_replace(run.log, joined, "$01address=65535:65535 result=fail$2");
  EXPECT_EQ(broken_in(judged({run.capture, other})), "J8-FAIL");
}

TEST(AlignLogs, EachSecondTickThatIsLeftOutIsFound) {
  const Recorded run = recorded("hospital");
  const std::regex step("(set_time_step\\(clock=)\\d+");
  ASSERT_TRUE(std::regex_search(run.log, step));
  const std::string other = std::regex_replace(run.log, step, "$01250");
  const std::string found = broken_in(judge(read_both({run.capture, other}), {}));
  EXPECT_NE(found.find("S2-SEND"), std::string::npos) << found;
}

// Captures as sniffers and taps make them: that begin late or end early, with stamps that scatter,
// with frames that came damaged or are another network's.

constexpr const char* kScenarios[] = {"timeline", "home", "open_door", "two_sinks", "hospital"};

int in_one_file(Packet&) { return 0; }

TEST(LawfulCaptures, ATapBeginsLateOrEndsEarly) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;
    read_apart(run.capture, 1,
               [&](Packet& packet) {
                 if (begin_ns == 0) begin_ns = packet.time_ns;
                 end_ns = packet.time_ns;
                 return 0;
               },
               {});
    for (const int tenth : {1, 3, 5, 7, 9}) {
      const std::int64_t cut_ns = begin_ns + (end_ns - begin_ns) / 10 * tenth;
      for (const bool late : {false, true}) {
        for (const bool of_radio : {false, true}) {
          const auto files = [&](Packet& packet) {
            if (is_radio(packet) == of_radio && (packet.time_ns < cut_ns) == late) return -1;
            return is_radio(packet) ? 0 : 1;
          };
          EXPECT_EQ(broken_in(judge(read_apart(run.capture, 2, files, {}), {})), "")
              << scenario << " " << tenth << " " << late << " " << of_radio;
          EXPECT_EQ(broken_in(judge(read_apart(run.capture, 2, files, {run.log}), {})), "")
              << scenario << " " << tenth << " " << late << " " << of_radio << ", with a log";
        }
      }
    }
  }
}

// A device that repeats what it heard long ago is no new life of the mote that it copies, whose
// numbers come round to that again.
TEST(LawfulCaptures, AnOldFrameComesAgain) {
  constexpr std::uint8_t kMote = 3;
  constexpr std::size_t kSrc = 7;  // The low byte of the source in a frame's bytes.
  RunReader reader;
  const std::uint32_t file = reader.open("capture");
  std::vector<std::uint8_t> old;
  int frames = 0;
  each_packet(recorded("hospital", 200'000'000).capture,
              [&](const Packet& packet, const std::string& interface) {
                reader.take(file, packet, interface);
                if (!is_radio(packet) || packet.bytes.size() < 20) return;
                if (packet.bytes[kSrc] != kMote) return;
                if (++frames == 60) old.assign(packet.bytes.begin(), packet.bytes.end());
                if (frames != 150) return;
                Packet again = packet;
                again.bytes = Bytes(old.data(), old.size());
                again.fcs = kAbsent;
                again.time_ns += 6'000'000;
                reader.take(file, again, interface);
              });
  ASSERT_GT(frames, 400);
  const Report report = judge(reader.finish(), complete());
  EXPECT_EQ(broken_in(report), "");
  EXPECT_EQ(report.verdict, Verdict::kStray);
}

TEST(LawfulCaptures, StampsScatter) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    const Recorded run = recorded(scenario);
    for (const std::int64_t most_us : {1000, 10'000, 20'000}) {
      for (const std::uint32_t seed : {1U, 2U, 3U}) {
        EXPECT_EQ(broken(run, scatters(most_us, seed)), "")
            << scenario << " " << most_us << " " << seed;
      }
    }
  }
}

// A host stamps what it is handed: a sniffer's frames late, or those of a line, which wait for
// more.
TEST(LawfulCaptures, OneTapIsStampedLate) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    const Recorded run = recorded(scenario);
    for (const bool radio : {false, true}) {
      for (const int ms : {8, 16, 30, 45}) {
        const auto late_ns = [&](const Packet& packet) {
          return packet.time_ns + (is_radio(packet) == radio ? std::int64_t{ms} * 1'000'000 : 0);
        };
        for (const Options& options : {Options{}, complete()}) {
          EXPECT_EQ(broken_in(judge(read_sorted(run.capture, late_ns), options)), "")
              << scenario << " " << (radio ? "radio " : "line ") << ms;
        }
      }
    }
  }
}

// A late answer passes (decision 125), whatever else the sink sends before.
TEST(LawfulCaptures, ASinkIsSlow) {
  for (const char* scenario : {"timeline", "home", "two_sinks", "hospital"}) {
    const Recorded run = recorded(scenario);
    for (const int ms : {350, 600, 1200}) {
      const auto late = [&](Packet& packet) {
        packet.time_ns += is_radio(packet) ? 0 : std::int64_t{ms} * 1'000'000;
        return 0;
      };
      EXPECT_EQ(broken(run, late), "") << scenario << " " << ms;
    }
  }
}

TEST(LawfulCaptures, TheClockOfOneTapSteps) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    for (const int ms : {600, 1900, -850}) {
      for (const int from : {10, 40}) {
        int packets = 0;
        const auto stepped = [&](Packet& packet) {
          const bool moves = ++packets > from && !is_radio(packet);
          packet.time_ns += moves ? std::int64_t{ms} * 1'000'000 : 0;
          return 0;
        };
        EXPECT_EQ(broken(run, stepped), "") << scenario << " " << ms << " from packet " << from;
      }
    }
  }
}

TEST(LawfulCaptures, TheClockOfOneRecorderSteps) {
  for (const char* scenario : {"timeline", "home", "hospital"}) {
    const Recorded run = recorded(scenario);
    for (const int ms : {1800, 2100}) {
      for (const int from : {4, 12}) {
        int lines = 0;
        const auto stepped = [&](Packet& packet) {
          if (is_radio(packet)) return 0;
          packet.time_ns += ++lines > from ? std::int64_t{ms} * 1'000'000 : 0;
          return 1;
        };
        EXPECT_EQ(broken_in(judge(read_apart(run.capture, 2, stepped, {}), complete())), "")
            << scenario << " " << ms << " from packet " << from;
      }
    }
  }
}

// A sniffer hears noise; what it hears damaged, nodes may have heard well.
TEST(LawfulCaptures, FramesComeDamaged) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    for (const int part : {5, 11}) {
      int frames = 0;
      const auto damaged = [&](Packet& packet) {
        if (is_radio(packet) && ++frames % part == 0) packet.fcs ^= 1;
        return 0;
      };
      EXPECT_EQ(broken(run, damaged), "") << scenario << " " << part;
    }
  }
}

// Every fifth frame again, by a node of a network with another PAN, which shares the air.
TEST(LawfulCaptures, AnotherNetworkIsInTheAir) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    RunReader reader;
    const std::uint32_t file = reader.open("capture");
    int frames = 0;
    each_packet(run.capture, [&](const Packet& packet, const std::string& interface) {
      reader.take(file, packet, interface);
      constexpr std::size_t kPanOffset = 3;
      if (!is_radio(packet) || packet.bytes.size() < 12 || ++frames % 5 != 0) return;
      std::vector<std::uint8_t> bytes(packet.bytes.begin(), packet.bytes.end());
      bytes[kPanOffset] = 0x33;
      Packet other = packet;
      other.bytes = Bytes(bytes.data(), bytes.size());
      other.fcs = kAbsent;
      other.time_ns += 1000;
      reader.take(file, other, interface);
    });
    const Report report = judge(reader.finish(), complete());
    const Report alone = judge(read_apart(run.capture, 1, in_one_file, {}), complete());
    EXPECT_EQ(broken_in(report), "") << scenario;
    EXPECT_EQ(report.verdict, alone.verdict) << scenario;
    EXPECT_THAT(report.facts, Contains(HasSubstr("PAN 0x0033"))) << scenario;
  }
}

TEST(LawfulCaptures, ALengthThatIsNotThatOfThePacketIsFound) {
  const Recorded run = recorded("timeline");
  std::string changed;
  EXPECT_EQ(broken(run, shortens(7, changed)), "WIRE-AM-LENGTH");
  EXPECT_EQ(broken(run, in_one_file), "");
}

}  // namespace
}  // namespace rubric::check
