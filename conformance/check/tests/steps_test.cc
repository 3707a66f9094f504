// Clocks that step, and stamps that are wrong: found and said, and what does not span them is
// judged as ever.
#include "conformance/check/align/steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing.h"
#include "conformance/selftest/lawful_traffic/generate.h"

namespace rubric::check {
namespace {

using ::testing::HasSubstr;

// Moves the stamps from `ms` on, as a recorder would; frames keep their order.
check::Run stepped_at(Script script, double ms, double by_ms, std::size_t count = SIZE_MAX,
                      std::int64_t response_us = 0) {
  for (Observation& seen : script.run.seen) {
    if (seen.place.time_us < static_cast<std::int64_t>(ms * 1000) || count == 0) continue;
    seen.place.time_us += static_cast<std::int64_t>(by_ms * 1000);
    --count;
  }
  mend_steps(script.run, response_us);
  place_steps(script.run);
  merge(script.run);
  return script.run;
}

// Mote 2 sends a message each 400 ms, with the numbers `first` to `last`.
void send(Script& script, int first, int last) {
  for (int i = first; i <= last; ++i) {
    NetFields up{.dest = {11, machine::kNullDevid},
                 .src = {11, 2},
                 .seq_num = static_cast<std::uint16_t>(i)};
    script.net(400 * i, 2, 1, up).up(400 * i + 15, up.forwarded());
  }
}

// Two motes join, at 0 and 1000 ms; the first one sends messages.
Script busy() {
  Script script = Script().join(0, 11, 2, 100);
  send(script, 1, 2);
  script.join(1000, 11, 3, 200);
  send(script, 3, 19);
  return script;
}

TEST(Steps, AreFoundAndSaid) {
  check::Run run = stepped_at(busy(), 3000, -100'000);
  ASSERT_EQ(run.steps.size(), 1U);
  EXPECT_FALSE(run.steps[0].alone());
  ASSERT_EQ(run.facts.size(), 1U);
  EXPECT_THAT(run.facts[0], HasSubstr("the clock of script steps back by 99.615 s at frame"));
  EXPECT_TRUE(failures_of(judge(run, complete())).empty());
  EXPECT_TRUE(
      stepped_at(busy(), 3000, -5).steps.empty());  // Less than the time to the frame before.
}

TEST(Steps, OneWrongStampIsNoStep) {
  for (const double by_ms : {-100'000.0, 100'000.0}) {
    check::Run run = stepped_at(busy(), 3200, by_ms, 1);
    ASSERT_EQ(run.steps.size(), 1U) << by_ms;
    EXPECT_TRUE(run.steps[0].alone());
    ASSERT_EQ(run.facts.size(), 1U);
    EXPECT_THAT(run.facts[0], HasSubstr("is wrong by about"));
    EXPECT_TRUE(failures_of(judge(run, complete())).empty());
    const std::int64_t at_us = run.steps[0].time_us;
    EXPECT_GE(at_us, 2'800'000);
    EXPECT_LE(at_us, 3'600'000);
  }
}

TEST(Steps, TurnedFramesOfOneTapKeepTheOrderOfTheFile) {
  Script script = busy();
  NetFields more{.dest = {11, machine::kNullDevid}, .src = {11, 1}};
  script.up(7620, more);
  script.run.seen.back().place.time_us -= 8'000;  // Before the one before it.
  const std::uint64_t last = script.run.seen.back().place.frame;
  check::Run run = stepped_at(script, 0, 0);
  EXPECT_TRUE(run.steps.empty());
  EXPECT_EQ(run.turned.size(), 1U);  // It is judged in the order of the stamps, too.
  std::uint64_t frame = 0;
  for (const Observation& seen : run.seen) {
    if (seen.tap != 1) continue;
    EXPECT_GT(seen.place.frame, frame);
    frame = seen.place.frame;
  }
  EXPECT_EQ(frame, last);
}

TEST(Steps, ALinkAckThatComesMuchLaterShowsOneForth) {
  Script between = Script().request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100);
  between.link_ack().joined(21, 11, 2);  // On a line.
  std::swap(between.run.seen.back(), between.run.seen.rbegin()[1]);
  for (const Script& script : {busy(), Script().join(0, 11, 2, 100), between}) {
    // Of two frames with one number few may be captured: among few frames it must be much later.
    const double by_ms = script.run.seen.size() < 40 ? 10'000 : 400;
    for (const Observation& seen : script.run.seen) {
      if (seen.kind != Observation::Kind::kLinkAck) continue;
      const check::Run run =
          stepped_at(script, static_cast<double>(seen.place.time_us) / 1000, by_ms);
      ASSERT_EQ(run.steps.size(), 1U);
      EXPECT_THAT(run.facts[0], HasSubstr("forth"));
      EXPECT_TRUE(failures_of(judge(run, complete())).empty());
    }
  }
}

TEST(Steps, ARepeatedAckJoinShowsOneForthAmongAFewFrames) {
  for (const bool two : {false, true}) {
    Script script = Script().request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100);
    if (two) script.reply(30, 12, 2, 100, 30);  // The mote has chosen.
    script.ack_join(40, 11, 2, 100).link_ack().joined(60, 11, 2);
    send(script, 1, 4);
    const check::Run run = stepped_at(script, 30, 10'000);
    EXPECT_EQ(run.steps.size(), 1U) << two;
    EXPECT_TRUE(failures_of(judge(run, complete())).empty()) << two;
  }
}

// Of two taps in files of their own, whose steps nothing else shows.
TEST(Steps, AnAckShowsOneForthAmongAFewFrames) {
  const NetFields down = message({11, machine::kNullDevid}, {11, 2}, 7, 1);
  Script script = Script().request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100);
  script.net(2000, 1, 2, down, 11).net(2010, 2, 1, down.ack(8));
  EXPECT_EQ(stepped_at(script, 2010, 6'000).steps.size(), 1U);
  EXPECT_TRUE(stepped_at(script, 0, 0).steps.empty());
}

// Two replies of a sink, between which a link ack comes so much later than it should.
check::Run replies_around(double forth_ms, std::uint32_t second_clock_ms) {
  Script script = Script().join(0, 11, 2, 100);
  script.join(1000, 11, 3, 200);  // Says 1010.
  send(script, 3, 19);
  script.request(7700, 4, 300).reply(7710, 11, 4, 300, second_clock_ms);
  script.ack_join(7720, 11, 4, 300).link_ack().joined(7740, 11, 4);
  return stepped_at(script, 1021, forth_ms);
}

// A clock that was set forth shows more time than passed, but between two frames no less than none.
TEST(Steps, OneForthDoesNotHideTheClockOfASink) {
  for (const double forth_ms : {120.0, 400.0, 3000.0}) {
    const check::Run right = replies_around(forth_ms, 7710);
    ASSERT_EQ(right.steps.size(), 1U) << forth_ms;
    EXPECT_EQ(broken_in(judge(right, complete())), "") << forth_ms;
    EXPECT_EQ(broken_in(judge(replies_around(forth_ms, 1010), complete())), "J3-TIME") << forth_ms;
    EXPECT_EQ(broken_in(judge(replies_around(forth_ms, 21'010), complete())), "J3-DRIFT (weak)")
        << forth_ms;
  }
  // What passed in a step back may be anything.
  EXPECT_EQ(broken_in(judge(replies_around(-100'000, 1010), complete())), "");
}

// A base station's ack goes by way of its sink, as the message does: that takes longer than one
// response, on the air alone as well.
TEST(Steps, TheAckOfABaseStationIsNotLate) {
  for (const bool whole : {true, false}) {
    Script script = busy();
    NetFields up;
    up.dest = {11, machine::kNullDevid};
    up.src = {11, 2};
    up.reliable = 1;
    up.seq_num = 50;
    const NetFields ack = up.ack(7);
    script.net(8000, 2, 1, up).up(8200, up.forwarded()).down(8350, ack).net(8500, 1, 2, ack, 11);
    if (!whole) std::erase_if(script.run.seen, [](const Observation& one) { return one.tap != 0; });
    for (int i = 0; !whole && i < 40; ++i) script.request(9000 + 600 * i, 9, 900);
    EXPECT_TRUE(stepped_at(script, 0, 0).steps.empty()) << whole;
  }
}

// A forward that is late only by the profile's response time: the node states another.
TEST(Steps, ASlowNodeThatStatesItShowsNone) {
  Script script = busy();
  script.net(8000, 2, 1, update(2, 50)).up(9600, update(2, 50).forwarded());
  EXPECT_EQ(stepped_at(script, 0, 0).steps.size(), 1U);
  EXPECT_EQ(stepped_at(script, 0, 0, 0, 1'500'000).steps.size(), 1U) << "It is later than that.";
  EXPECT_TRUE(stepped_at(script, 0, 0, 0, 2'000'000).steps.empty());
}

// A lawful mote repeats its ack_join for less than a second, and need not repeat it at all.
TEST(Steps, ALateAckJoinBetweenOrdinarySilencesShowsNone) {
  for (const int last : {19, 5}) {
    Script script = Script().join(0, 11, 2, 100).join(100, 11, 3, 200);
    send(script, 1, 3);
    script.ack_join(1590, 11, 3, 200);
    send(script, 4, last);
    const check::Run run = stepped_at(script, 0, 0);
    EXPECT_TRUE(run.steps.empty()) << last;
    EXPECT_EQ(broken_in(judge(run, complete())), "J4-REPEAT") << last;
  }
}

// A request that comes too early: blamed before the step and after it, but not across it.
TEST(Steps, OnlyWhatSpansThemIsInconclusive) {
  for (const double at_ms : {2000.0, 5000.0}) {
    Script script = busy();
    script.request(at_ms, 4, 300).request(at_ms + 100, 4, 300);
    std::sort(script.run.seen.begin(), script.run.seen.end(),
              [](const Observation& a, const Observation& b) {
                return a.place.time_us < b.place.time_us;
              });
    const std::multiset<std::string> whole =
        failures_of(judge(stepped_at(script, 0, 0), complete()));
    ASSERT_EQ(whole.size(), 1U);
    for (const double by_ms : {-100'000.0, -700.0}) {
      EXPECT_EQ(failures_of(judge(stepped_at(script, 3000, by_ms), complete())), whole) << by_ms;
      const check::Run across = stepped_at(script, at_ms + 50, by_ms);
      ASSERT_FALSE(across.steps.empty());
      EXPECT_TRUE(failures_of(judge(across, complete())).empty());
      const Report report = judge(across, complete());
      EXPECT_EQ(report.verdict, Verdict::kInconclusive);
    }
  }
}

TEST(Steps, TapsOneAfterTheOtherInOneFileDoNotStep) {
  Script script = busy();
  std::stable_sort(script.run.seen.begin(), script.run.seen.end(),
                   [](const Observation& a, const Observation& b) { return a.tap < b.tap; });
  const check::Run run = stepped_at(script, 0, 0);
  EXPECT_TRUE(run.steps.empty());
  EXPECT_TRUE(run.facts.empty());
}

// A sink of lawful traffic forwards one message twice; far from it the clock steps.
TEST(Steps, ARealFaultInAStretchWithoutOneIsFound) {
  std::size_t planted = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    lawful::Traffic traffic = lawful::generate("usual", seed);
    const auto run_of = [&] { return must_read("usual", lawful::to_pcapng(traffic)); };
    constexpr std::int64_t kBaseUs = 10'000'000'000;
    for (lawful::LawfulPacket& packet : traffic.packets) packet.time_us += kBaseUs;
    // The sink forwards one message twice, in the first half or in the second one.
    const bool early = seed % 2 == 0;
    const std::size_t middle = traffic.packets.size() / 2;
    std::size_t victim = early ? middle / 2 : middle + middle / 2;
    const auto up = [&](const lawful::LawfulPacket& packet) {
      return packet.interface != "radio" && packet.direction == Direction::kOutbound &&
             packet.record.size() > 30;
    };
    while (victim + 1 < traffic.packets.size() && !up(traffic.packets[victim])) ++victim;
    const auto place = traffic.packets.begin() + static_cast<std::ptrdiff_t>(victim);
    traffic.packets.insert(place, lawful::LawfulPacket(*place));
    const std::multiset<std::string> found = failures_of(judge(run_of(), complete()));
    if (found.empty()) continue;
    ++planted;
    const std::size_t step = early ? middle + middle / 2 : middle / 2;
    for (const std::int64_t by_us : {-600'000'000LL, -1'500'000LL, 900'000'000LL}) {
      lawful::Traffic whole = traffic;
      for (std::size_t i = step; i < traffic.packets.size(); ++i) {
        traffic.packets[i].time_us += by_us;
      }
      const check::Run run = run_of();
      EXPECT_FALSE(run.steps.empty()) << seed << " " << by_us;
      EXPECT_EQ(failures_of(judge(run, complete())), found) << seed << " " << by_us;
      traffic = std::move(whole);
    }
  }
  EXPECT_GE(planted, 15U);
}

}  // namespace
}  // namespace rubric::check
