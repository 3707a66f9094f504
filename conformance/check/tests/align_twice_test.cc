// One air or line that was recorded twice beside others gives the findings of one recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "conformance/check/align/align.h"
#include "conformance/check/input/duplicates.h"
#include "conformance/check/message.h"
#include "conformance/check/tests/align_testing.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check::align_twice_test {
namespace {

// Each lasts longer than the clocks of two sniffers may differ; else the two share no time.
constexpr const char* kCaptures[] = {"a2_join_data_sensible_start",
                                     "a_join_data",
                                     "b_reliable",
                                     "c_two_islands",
                                     "d1_lose_request",
                                     "e1_simultaneous_join",
                                     "f_synaptic",
                                     "h4_stale_bytes",
                                     "h10_hdlc_escape_and_bad_serial"};
constexpr double kShifts_s[] = {0, 0.004, -0.004, 0.03, -0.03};

struct Outcome {
  std::vector<std::string> facts;  // About lines, as if each sniffer were the first.
  std::size_t loose = 0;
  Report report;
};

Outcome outcome_of(const std::vector<Part>& parts) {
  RunReader reader;
  std::string error;
  for (const Part& part : parts) EXPECT_TRUE(reader.add_bytes(part.name, part.bytes, error));
  check::Run run = reader.finish();
  Outcome out;
  for (const std::string& fact : run.facts) {
    if (!fact.starts_with("serial")) continue;
    const std::size_t second = fact.find("second");
    out.facts.push_back(fact);
    if (second != fact.npos) out.facts.back().replace(second, 6, "radio");
  }
  out.loose = run.loose.size();
  EXPECT_TRUE(drop_duplicates(run, {}, error)) << error;
  out.report = judge(run, {});
  return out;
}

void expect_same(const Outcome& twice, const Outcome& once, const std::string& what) {
  EXPECT_EQ(twice.facts, once.facts) << what;
  EXPECT_EQ(twice.loose, once.loose) << what;
  EXPECT_EQ(findings_of(twice.report, nullptr, false), findings_of(once.report, nullptr, false))
      << what;
  EXPECT_EQ(twice.report.exercised, once.report.exercised) << what;
}

// Keeps some frames of a file, by their numbers from 1.
std::string frames_of(const std::string& bytes,
                      const std::function<bool(std::size_t number)>& taken) {
  std::string out;
  PcapngWriter writer;
  writer.begin(out);
  const std::unique_ptr<Reader> reader = make_reader(InputFormat::kPcapng, {});
  std::size_t number = 0;
  auto take = [&](const Packet& packet) {
    if (!taken(++number)) return;
    writer.write(packet, reader->interfaces()[packet.interface_id].name, out);
  };
  reader->feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
               PacketSink(take));
  reader->finish(PacketSink(take));
  writer.finish(out);
  return out;
}

// Expects two sniffers of the air, one of which may miss frames, to count as one.
void expect_one_air(const std::string& name, const SerialClock& clock) {
  const std::string bytes = capture(name);
  const Apart apart = take_apart(bytes, clock);
  for (const double shift_s : kShifts_s) {
    for (const double lost : {0.0, 0.2, 0.6}) {
      SerialClock other = clock;
      other.base_s += shift_s;
      other.lost = lost;
      Part second = take_apart(bytes, other).parts[0];
      second.name = "second";
      const Outcome once = outcome_of(apart.parts);
      std::vector<Part> parts = apart.parts;
      const std::string what =
          name + ", " + std::to_string(shift_s) + " s, lost " + std::to_string(lost);
      parts.insert(parts.begin() + 1, second);
      expect_same(outcome_of(parts), once, what);
      if (lost == 0) continue;  // If both have the same, the first counts.
      std::swap(parts[0], parts[1]);
      expect_same(outcome_of(parts), once, what + " by the first");
    }
  }
}

TEST(AlignTwice, TwoSniffersAndLinesWithoutStamps) {
  SerialClock clock{.stamps = false};
  std::size_t loose = 0;
  for (const char* name : kCaptures) {
    expect_one_air(name, clock);
    loose += outcome_of(take_apart(capture(name), clock).parts).loose;
  }
  EXPECT_GT(loose, 200U);
}

TEST(AlignTwice, TwoSniffersAndALineOnAnotherClock) {
  SerialClock clock{.ahead_s = -777, .drift_ppm = 40};
  for (const char* name : kCaptures) expect_one_air(name, clock);
}

// One sniffer takes over from another one while that still listens.
TEST(AlignTwice, ASnifferThatTakesOver) {
  SerialClock clock{.stamps = false};
  const Apart apart = take_apart(capture("a_join_data"), clock);
  const Outcome once = outcome_of(apart.parts);
  std::vector<Part> parts = apart.parts;
  const std::string air = parts[0].bytes;
  const std::size_t all = parts[0].frames.size() - 1;
  parts.insert(parts.begin() + 1, Part{"second", {}, {0}});
  parts[0].bytes = frames_of(air, [&](std::size_t number) { return number <= all * 3 / 5; });
  parts[1].bytes = frames_of(air, [&](std::size_t number) { return number >= all * 2 / 5; });
  const Outcome twice = outcome_of(parts);
  EXPECT_EQ(twice.facts, once.facts);
  EXPECT_EQ(twice.loose, once.loose);
  EXPECT_EQ(twice.report.exercised, once.report.exercised);
}

// Each of two sniffers misses what the other one has: the line is in order with both together.
TEST(AlignTwice, TwoSniffersThatBothMissFrames) {
  for (const char* name : kCaptures) {
    SerialClock clock{.stamps = false};
    const Apart apart = take_apart(capture(name), clock);
    const check::Run once = put_together(apart);
    for (const double shift_s : {0.0, 0.001, -0.001}) {
      clock.base_s = SerialClock{}.base_s + shift_s;
      Apart twice = apart;
      Part second{"second", take_apart(capture(name), clock).parts[0].bytes, {0}};
      Part& first = twice.parts[0];
      first.bytes = frames_of(first.bytes, [](std::size_t i) { return i % 3 != 0; });
      second.bytes = frames_of(second.bytes, [](std::size_t i) { return i % 3 != 1; });
      twice.parts.insert(twice.parts.begin() + 1, second);
      const check::Run run = put_together(twice);
      EXPECT_EQ(aligned_fact(run), aligned_fact(once)) << name << ", " << shift_s << " s";
      EXPECT_EQ(run.loose.size(), once.loose.size()) << name << ", " << shift_s << " s";
    }
  }
}

// Returns which rules the nodes have broken.
std::set<std::string> blamed_in(const Report& report) {
  std::set<std::string> out;
  for (const Finding& finding : report.findings) {
    if (finding.severity != Severity::kFail) continue;
    out.insert(reflect::requirement(finding.requirement).id + (" " + finding.node));
  }
  return out;
}

// The same where their clocks differ: the frames that both heard are what they have in common, and
// no line says anything more exactly.
TEST(AlignTwice, TwoSniffersOnOtherClocksThatBothMissFrames) {
  std::size_t lines = 0;
  for (const char* name : {"a_join_data", "b_reliable", "c_two_islands", "f_synaptic"}) {
    SerialClock clock{.ahead_s = -777};
    const Apart apart = take_apart(capture(name), clock);
    clock.base_s += 2;
    Part first{"radio", frames_of(apart.parts[0].bytes, [](auto i) { return i % 5 != 0; }), {0}};
    Part second{"second", take_apart(capture(name), clock).parts[0].bytes, {0}};
    second.bytes = frames_of(second.bytes, [](auto i) { return i % 5 != 1; });
    std::vector<Part> parts = apart.parts;
    parts[0] = first;
    const std::set<std::string> blamed = blamed_in(judge(whole_run(apart), {}));
    for (const bool line : {true, false}) {
      if (!line) parts = {first};
      lines += parts.size() - 1;
      parts.insert(parts.begin() + 1, second);
      check::Run run = put_together({parts, {}});
      EXPECT_THAT(run.facts,
                  ::testing::Contains(::testing::HasSubstr("second is aligned with radio "
                                                           "by ")))
          << name;
      EXPECT_THAT(run.facts, ::testing::Contains(::testing::HasSubstr("2.000000 s ahead"))) << name;
      std::string error;
      EXPECT_TRUE(drop_duplicates(run, {}, error)) << name << ": " << error;
      EXPECT_THAT(blamed, ::testing::IsSupersetOf(blamed_in(judge(run, {})))) << name;
    }
  }
  EXPECT_EQ(lines, 4U);
}

// Two sniffers of one air, the second one's clock ahead by so much: the first misses frame `lost`,
// the second some others.
check::Run two_sniffers(const Script& script, std::uint64_t lost, std::int64_t ahead_us,
                        bool second_first) {
  check::Run run = script.run;
  run.files = {"first", "second"};
  run.taps = {{"radio", machine::Link::kRadio, false}, {"radio", machine::Link::kRadio, false}};
  run.seen.clear();
  for (const std::uint32_t file : {0U, 1U}) {
    const bool ahead = (file == 1) != second_first;
    for (Observation seen : script.run.seen) {
      const std::uint64_t frame = seen.place.frame;
      if (seen.tap != 0 || (ahead ? frame % 9 == 4 && frame != lost : frame == lost)) continue;
      seen.place.file = seen.tap = file;
      seen.place.time_us += 1'000'000 + (ahead ? ahead_us : 0);
      run.seen.push_back(seen);
    }
  }
  align(run, {});
  merge(run);
  std::string error;
  EXPECT_TRUE(drop_duplicates(run, {}, error)) << error;
  return run;
}

// Mote 3 asks, the sinks of islands 11 and 12 answer; it takes the offer of 12, which comes at
// `offer_ms`, at 3015 ms.
Script choice(double offer_ms) {
  Script script = Script().join(100, 11, 2, 500).join(300, 12, 5, 550, 2);
  const auto send = [&](double ms, std::uint16_t island, std::uint16_t mote, int i) {
    NetFields up;
    up.dest = {island, machine::kNullDevid};
    up.src = {island, mote};
    up.seq_num = static_cast<std::uint16_t>(700 + i);
    script.net(ms, mote, 1, up);
  };
  for (int i = 0; i < 8; ++i) send(600 + 250 * i, i % 2 == 0 ? 11 : 12, i % 2 == 0 ? 2 : 5, i);
  script.request(3000, 3, 600);
  const auto offer = [&] { script.reply(offer_ms, 12, 3, 600, 3008); };
  if (offer_ms < 3015) offer();
  script.reply(3010, 11, 3, 600, 3010).ack_join(3015, 12, 3, 600).link_ack();
  if (offer_ms > 3015) offer();
  for (int i = 0; i < 8; ++i) send(3600 + 250 * i, 12, 3, 20 + i);
  return script;
}

// What only one of two sniffers heard of an exchange is in its place, however their clocks differ.
TEST(AlignTwice, OnlyOneOfTwoSniffersHeardAnOffer) {
  for (const std::int64_t ahead_us : {0, 8'000, -8'000, 45'000, -45'000}) {
    for (const bool second_first : {false, true}) {
      for (const double offer_ms : {3005.0, 3020.0}) {
        const Script script = choice(offer_ms);
        const auto offered = std::ranges::find_if(script.run.seen, [](const Observation& seen) {
          return seen.frame.type == am::kJoinReply && seen.place.time_us > 3'000'000 &&
                 seen.frame.payload[1] == 12;
        });
        const check::Run run = two_sniffers(script, offered->place.frame, ahead_us, second_first);
        EXPECT_EQ(broken_in(judge(run, {})), offer_ms < 3015 ? "" : "J7-CHOICE")
            << ahead_us << " us, offer at " << offer_ms << " ms";
      }
    }
  }
}

// Only the line of one sink has no stamps; the other sink's line shows nothing of it.
TEST(AlignTwice, ALineWithStampsBesideOneWithout) {
  SerialClock raw{.stamps = false};
  const std::string bytes = capture("c_two_islands");
  const Apart apart = take_apart(bytes, raw);
  ASSERT_EQ(apart.parts.size(), 3U);
  for (const std::size_t i : {1U, 2U}) {
    const Part& line = apart.parts[i];
    const Part timed = only_interface(take_apart(bytes, {}).whole, apart.parts[3 - i].name);
    const Outcome alone = outcome_of({apart.parts[0], line});
    const Outcome beside = outcome_of({apart.parts[0], timed, line});
    EXPECT_EQ(beside.loose, alone.loose) << line.name;
    EXPECT_GT(beside.loose, 0U) << line.name;
  }
}

// A line without stamps that is given twice is ordered as it is alone.
TEST(AlignTwice, OneLineTwice) {
  SerialClock raw{.stamps = false};
  for (const char* name : kCaptures) {
    std::vector<Part> parts = take_apart(capture(name), raw).parts;
    if (parts.size() != 2) continue;
    const Outcome once = outcome_of(parts);
    parts.push_back(parts[1]);
    parts.back().name = "again";
    const Outcome twice = outcome_of(parts);
    EXPECT_EQ(twice.facts, once.facts) << name;
    EXPECT_EQ(findings_of(twice.report, nullptr, false), findings_of(once.report, nullptr, false))
        << name;
    EXPECT_EQ(twice.report.exercised, once.report.exercised) << name;
  }
}

// A recorder that begins another file does not set its clock: frames that were under way come late.
TEST(AlignTwice, AFileThatGoesOnWhereAnotherEnds) {
  Script script = Script().join(0, 11, 2, 100).join(200, 11, 3, 200).join(400, 11, 4, 300);
  for (std::uint16_t mote = 2; mote < 5; ++mote) {
    script.net(1000 + 15 * mote, mote, 1, update(mote, 5));
  }
  const std::size_t cut = script.run.seen.size();
  for (std::uint16_t mote = 2; mote < 5; ++mote) {
    script.up(1200 + 15 * mote, update(mote, 5).forwarded());
    script.net(1207 + 15 * mote, mote, 1, update(mote, 6));
    script.up(1212 + 15 * mote, update(mote, 6).forwarded());
  }
  for (const int hours : {0, 1}) {
    check::Run run = script.run;
    run.files = {"1", "2"};
    for (std::size_t i = cut; i < run.seen.size(); ++i) {
      run.seen[i].place.file = 1;
      run.seen[i].place.time_us += hours * 3'600'000'000;
    }
    align(run, {});
    EXPECT_THAT(run.facts, testing::SizeIs(hours)) << hours;
  }
}

}  // namespace
}  // namespace rubric::check::align_twice_test
