// Captures that are of different runs, or that any shift would fit, are left as they are.
#include <gtest/gtest.h>

#include "conformance/check/align/align.h"
#include "conformance/check/input/duplicates.h"
#include "conformance/check/tests/align_testing.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kSecondUs = 1'000'000;

check::Run together(const std::vector<Part>& parts) {
  RunReader reader;
  std::string error;
  for (const Part& part : parts) EXPECT_TRUE(reader.add_bytes(part.name, part.bytes, error));
  return reader.finish();
}

// A run of two files that keep their own times: the air, and a line.
struct Tapes {
  Script script;
  std::int64_t line_ahead_us = 0;

  check::Run run() {
    check::Run out = script.run;
    out.files = {"radio", "serial"};
    std::stable_sort(out.seen.begin(), out.seen.end(),
                     [](const Observation& a, const Observation& b) { return a.tap < b.tap; });
    std::uint64_t number = 0;
    for (Observation& seen : out.seen) {
      seen.place.frame = ++number;
      if (seen.tap == 0) continue;
      seen.place.file = 1;
      seen.place.time_us += line_ahead_us;
    }
    return out;
  }
  // Sends number `seq_num` on the air at `s`, on the line 10 ms later; either may not be recorded.
  void forward(double s, std::uint16_t seq_num, bool on_air, bool on_line) {
    NetFields net{.dest = {11, machine::kNullDevid}, .src = {11, 2}, .seq_num = seq_num};
    if (on_air) script.net(1000 * s, 2, 1, net);
    if (on_line) script.up(1000 * s + 10, net.forwarded());
  }
};

std::int64_t first_on_line(const check::Run& run) {
  for (const Observation& seen : run.seen) {
    if (seen.place.file == 1) return seen.place.time_us;
  }
  return kNoStamp;
}

TEST(AlignRefused, TheSameFrameOverAndOver) {
  Tapes tapes{.line_ahead_us = 40 * kSecondUs + 300'000};
  for (int i = 0; i < 100; ++i) tapes.forward(i, 7, i < 80, i >= 20);
  check::Run run = tapes.run();
  const std::int64_t before_us = first_on_line(run);
  align(run, {});
  EXPECT_EQ(first_on_line(run), before_us);
  EXPECT_NE(aligned_fact(run).find("not aligned with radio"), std::string::npos);
  ASSERT_EQ(run.unordered_taps.size(), 3U);
  EXPECT_TRUE(run.unordered_taps[1]);
}

// A mote that boots every ten seconds and counts from 0: each life looks like the next one.
TEST(AlignRefused, LivesThatAreAllTheSame) {
  for (const int lives_on_air : {1, 2, 5}) {
    for (const int first_on_the_line : {0, 1, 2}) {
      Tapes tapes{.line_ahead_us = -500 * kSecondUs};
      for (int i = 0; i < 70; ++i) {
        const int life = i / 10;
        tapes.forward(i, static_cast<std::uint16_t>(i % 10), life < lives_on_air,
                      life >= first_on_the_line);
      }
      check::Run run = tapes.run();
      const std::int64_t before_us = first_on_line(run);
      align(run, {});
      EXPECT_EQ(first_on_line(run), before_us) << lives_on_air << " " << first_on_the_line;
      EXPECT_NE(aligned_fact(run).find("repeat"), std::string::npos) << aligned_fact(run);
      for (Observation& seen : run.seen) {
        if (seen.place.file == 1) seen.place.time_us = kNoStamp;
      }
      run.facts.clear();
      align(run, {});
      EXPECT_TRUE(run.loose.empty()) << lives_on_air << " " << first_on_the_line;
    }
  }
}

// Half of the frames say one shift, half another.
TEST(AlignRefused, TwoShiftsThatFitEquallyWell) {
  Tapes tapes;
  for (int i = 0; i < 40; ++i) {
    tapes.forward(i, static_cast<std::uint16_t>(i), true, false);
    tapes.forward(i + (i % 2 == 0 ? 100 : 200), static_cast<std::uint16_t>(i), false, true);
  }
  check::Run run = tapes.run();
  const std::int64_t before_us = first_on_line(run);
  align(run, {});
  EXPECT_EQ(first_on_line(run), before_us);
  EXPECT_NE(aligned_fact(run).find("do not lie equally far apart"), std::string::npos);
}

TEST(AlignRefused, LessThanThreeFrames) {
  for (const int count : {1, 2}) {
    Tapes tapes{.line_ahead_us = 7 * kSecondUs};
    for (int i = 0; i < count; ++i) tapes.forward(i, static_cast<std::uint16_t>(i), true, true);
    check::Run run = tapes.run();
    align(run, {});
    EXPECT_NE(aligned_fact(run).find("3 are needed"), std::string::npos) << aligned_fact(run);
  }
}

// Clocks run up to 100 ppm fast or slow; one that runs twice as fast is no clock.
TEST(AlignRefused, WhatNoClockDoes) {
  Tapes tapes;
  for (int i = 0; i < 60; ++i) {
    tapes.forward(i, static_cast<std::uint16_t>(i), true, false);
    tapes.forward(1000 + 2 * i, static_cast<std::uint16_t>(i), false, true);
  }
  check::Run run = tapes.run();
  align(run, {});
  EXPECT_NE(aligned_fact(run).find("not aligned"), std::string::npos) << aligned_fact(run);
}

// Some frames agree by chance while most of the time says otherwise.
TEST(AlignRefused, FewerFramesThanThoseThatAreMissing) {
  Tapes tapes{.line_ahead_us = 500 * kSecondUs};
  for (int i = 0; i < 60; ++i) {
    const bool both = i % 10 == 0;
    tapes.forward(i, static_cast<std::uint16_t>(i), true, both);
    if (!both) tapes.forward(i, static_cast<std::uint16_t>(1000 + i), false, true);
  }
  check::Run run = tapes.run();
  align(run, {});
  EXPECT_NE(aligned_fact(run).find("fewer than those"), std::string::npos) << aligned_fact(run);
}

TEST(AlignRefused, TheAirOfOneRunAndTheLineOfAnother) {
  const std::vector<std::string> names = {"a_join_data", "b_reliable", "c_two_islands",
                                          "e1_simultaneous_join", "h4_stale_bytes"};
  for (const std::string& air : names) {
    for (const std::string& line : names) {
      if (air == line) continue;
      for (const bool stamps : {true, false}) {
        SerialClock clock{.ahead_s = 777, .stamps = stamps};
        const Apart of_air = take_apart(capture(air), {});
        const Apart of_line = take_apart(capture(line), clock);
        const check::Run run = together({of_air.parts[0], of_line.parts[1]});
        EXPECT_NE(aligned_fact(run).find("not aligned"), std::string::npos)
            << air << " " << line << ": " << aligned_fact(run);
        EXPECT_TRUE(run.loose.empty());
        Options options{.sniffer_complete = true};
        const auto alone = findings_of(judge(together({of_air.parts[0]}), options), nullptr, true);
        for (const Finding& finding : judge(run, options).findings) {
          if (finding.severity != Severity::kFail || finding.place.file != 0) continue;
          Report one{.findings = {finding}};
          EXPECT_TRUE(alone.contains(*findings_of(one, nullptr, true).begin()))
              << air << " " << line << ": " << *findings_of(one, nullptr, true).begin();
        }
      }
    }
  }
}

}  // namespace
}  // namespace rubric::check
