// The same air or line in two files of a run.
#include "conformance/check/input/duplicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check {
namespace {

const std::string kFirmware = "spec/captures/firmware/";
const std::string kReliable = kFirmware + "b_reliable.pcapng";

std::string error_of(check::Run& run) {
  std::string error;
  const bool good = drop_duplicates(run, {}, error);
  EXPECT_EQ(good, error.empty());
  return error;
}

void same_findings(const check::Run& one, const check::Run& two) {
  const Report before = judge(one, {});
  const Report after = judge(two, {});
  EXPECT_EQ(after.frames, before.frames);
  ASSERT_EQ(after.findings.size(), before.findings.size());
  for (std::size_t i = 0; i < after.findings.size(); ++i) {
    EXPECT_EQ(after.findings[i].text, before.findings[i].text);
    EXPECT_EQ(after.findings[i].place.frame, before.findings[i].place.frame);
  }
}

TEST(Duplicates, AFileThatIsGivenTwiceIsJudgedOnce) {
  check::Run run = must_read({kReliable, kReliable});
  EXPECT_EQ(error_of(run), "");
  same_findings(must_read({kReliable}), run);
  ASSERT_EQ(run.facts.size(), 2U);  // Air and line.
  EXPECT_NE(run.facts[0].find("judged once"), std::string::npos);
}

TEST(Duplicates, TheBytesOfALineThatACaptureHasAreJudgedOnce) {
  for (const bool first : {false, true}) {
    std::vector<std::string> files = {kReliable, kFirmware + "b_reliable.serial.bin"};
    if (first) std::swap(files[0], files[1]);
    check::Run run = must_read(files);
    EXPECT_FALSE(run.has_time);
    EXPECT_EQ(error_of(run), "");
    EXPECT_TRUE(run.has_time);
    same_findings(must_read({kReliable}), run);
  }
}

TEST(Duplicates, ACaptureWithFewerFramesCountsOnlyThroughTheOther) {
  check::Run run = must_read({kReliable, kReliable});
  bool odd = false;
  std::erase_if(run.seen, [&](const Observation& seen) {
    if (seen.place.file != 0 || seen.kind != Observation::Kind::kRadio) return false;
    odd = !odd;
    return odd;
  });
  for (Observation& seen : run.seen) {  // Another clock.
    if (seen.place.file == 0) seen.place.time_us += 10'000;
  }
  merge(run);
  EXPECT_EQ(error_of(run), "");
  const auto frames = std::count_if(run.seen.begin(), run.seen.end(), [](const Observation& o) {
    return o.kind == Observation::Kind::kRadio;
  });
  const check::Run one = must_read({kReliable});
  EXPECT_EQ(frames, std::count_if(one.seen.begin(), one.seen.end(), [](const Observation& o) {
              return o.kind == Observation::Kind::kRadio;
            }));
}

TEST(Duplicates, TwoSniffersOfOneAirThatEachMissFramesAreOneCapture) {
  const check::Run one = must_read({kReliable});
  check::Run run = must_read({kReliable, kReliable});
  std::size_t radio = 0;
  std::erase_if(run.seen, [&](const Observation& seen) {
    if (seen.kind != Observation::Kind::kRadio && seen.kind != Observation::Kind::kLinkAck) {
      return seen.place.file == 1;
    }
    return radio++ % 8 == (seen.place.file == 0 ? 2 : 5);
  });
  EXPECT_EQ(error_of(run), "");
  same_findings(one, run);
}

TEST(Duplicates, CapturesOfTheSameTimeThatDisagreeAreRefused) {
  check::Run run = must_read({kReliable, kFirmware + "a_join_data.pcapng"});
  const std::string error = error_of(run);
  EXPECT_NE(error.find("a_join_data.pcapng: frame "), std::string::npos) << error;
  EXPECT_NE(error.find("--frames 2:none"), std::string::npos) << error;
}

TEST(Duplicates, CapturesOfOtherTimesAreOneRun) {
  check::Run run = must_read({kReliable, kFirmware + "a_join_data.pcapng"});
  const std::size_t size = run.seen.size();
  for (Observation& seen : run.seen) {
    if (seen.place.file == 1) seen.place.time_us += 3'600'000'000;
  }
  merge(run);
  EXPECT_EQ(error_of(run), "");
  EXPECT_EQ(run.seen.size(), size);
}

TEST(Duplicates, LinesOfTwoSinksAreTwoLines) {
  check::Run run = must_read(
      {kFirmware + "c_two_islands.serial.bin", kFirmware + "c_two_islands.node101.serial.bin"});
  const std::size_t size = run.seen.size();
  EXPECT_EQ(error_of(run), "");
  EXPECT_EQ(run.seen.size(), size);
}

TEST(Duplicates, WhatTwoSinksHandUpAlikeMakesTheirLinesNotOne) {
  const auto error = [](std::uint16_t to) {
    Script script;
    const NetFields both = message({11, 2}, {to, machine::kNullDevid}, 7);
    for (const std::uint32_t tap : {1U, 2U}) {
      script.up(20 + tap, both, tap);
      script.up(40, message({std::uint16_t(10 + tap), 1}, {to, machine::kNullDevid}, 8), tap);
    }
    for (Observation& seen : script.run.seen) seen.place.file = seen.tap - 1;
    script.run.files = {"a", "b"};
    merge(script.run);
    return error_of(script.run);
  };
  EXPECT_EQ(error(12), "");
  EXPECT_NE(error(11).find("which is of the same serial line"), std::string::npos) << error(11);
}

TEST(Duplicates, ANodeHasOneLogAndTheFramesOfACaptureBesideIt) {
  constexpr const char* kLog = R"(%rtr 1  %profile paper  %tick us
%node m2 mote id=2 whole

case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @1000 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
)";
  const auto logged = [](const Observation& seen) { return !seen.node.empty(); };
  for (const bool capture : {false, true}) {
    RunReader reader;
    std::string error;
    if (capture) {
      ASSERT_TRUE(reader.add_file(kReliable, error)) << error;
    }
    ASSERT_TRUE(reader.add_bytes("log", kLog, error)) << error;
    if (!capture) {
      ASSERT_TRUE(reader.add_bytes("again", kLog, error)) << error;
    }
    check::Run run = reader.finish();
    for (Observation& seen : run.seen) {
      if (!seen.node.empty()) seen.place.time_us += 5'000'000;
    }
    error = error_of(run);
    if (!capture) {
      EXPECT_EQ(error.find("again: what node m2 did is in log as well"), 0U) << error;
      continue;
    }
    EXPECT_EQ(error, "");
    EXPECT_EQ(std::ranges::count_if(run.seen, logged), 1) << "Its call, not its frame.";
    EXPECT_FALSE(run.nodes.front().whole || run.nodes.front().hearing);
    EXPECT_NE(run.facts.back().find("log: its frames on the air are left out, as "),
              std::string::npos)
        << run.facts.back();
  }
}

}  // namespace
}  // namespace rubric::check
