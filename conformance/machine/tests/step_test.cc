// Whole nodes: joining, calls, and what a frame causes from one end to the other.

#include "conformance/machine/step.h"

#include <gtest/gtest.h>

#include <limits>

#include "conformance/machine/profile.h"
#include "conformance/machine/tests/machine_fixture.h"
#include "conformance/machine/ticks.h"

namespace rubric::machine {
namespace {

using Payload = std::vector<std::uint8_t>;
using Phase = JoinMote::Phase;

TEST(JoinStep, SinkAnswersWithItsClock) {
  Device sink(sink_config());
  sink.now = 2048;
  sink.hear(join_request(5, 0x1234, kDescriptor));
  EXPECT_EQ(sink.labels(), (std::vector{sent("J3-REPLY"_rule)}));
  EXPECT_EQ(sink.only_frame().dest, 5);
  EXPECT_EQ(sink.only_frame().src, 1);
  // Island 11, mote 5, 2000 ms, the request's number.
  EXPECT_EQ(sink.only_payload(), (Payload{0, 11, 0, 5, 0, 0, 0x07, 0xD0, 0x12, 0x34}));
}

TEST(JoinStep, MoteAcceptsSetsItsClockAndAcks) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  mote.now = 512;
  mote.hear(join_reply(5, {kIsland, 5}, 700000, mote.state.join.seq_num));
  EXPECT_EQ(mote.labels(), (std::vector{notified("J5-SUCCESS"_rule), followed("J4-CLOCK"_rule),
                                        sent("J4-ACK"_rule)}));
  const Transmit& ack = mote.only_frame();
  EXPECT_TRUE(ack.link_ack);
  EXPECT_EQ(ack.dest, 1);
  EXPECT_EQ(mote.only_payload(), (Payload{0, 11, 0, 1, 0, 11, 0, 5, 0, 1, 1, 0, 0x43, 1}));
  mote.now = 1536;
  EXPECT_EQ(mote.call(GetClock{}).notice<Clock>().ms, 701000U);
  EXPECT_EQ(own_address(mote.state), (Address{kIsland, 5}));
}

TEST(JoinStep, AckJoinIsRepeatedAtOnceWhileTheLinkSaysNo) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  mote.hear(join_reply(5, {kIsland, 5}, 0, 1));
  const Payload ack = mote.only_payload();
  for (int i = 0; i < 4; ++i) {
    mote.done(Link::kRadio, false);
    EXPECT_EQ(mote.labels(), (std::vector{sent("J4-REPEAT"_rule)}));
    EXPECT_EQ(mote.only_payload(), ack);
  }
  mote.done(Link::kRadio, false);
  EXPECT_EQ(mote.labels(), (std::vector{followed("J4-FEW"_rule)}));
}

TEST(JoinStep, RepeatedAckJoinGoesBeforeWhatCameLater) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  mote.hear(join_reply(5, {kIsland, 5}, 0, 1));
  mote.call(Send{{kIsland, 1}, 10, false, {}});
  EXPECT_TRUE(mote.actions.transmits().empty());
  mote.done(Link::kRadio, false);
  EXPECT_EQ(mote.only_frame().type, am::kAckJoin);
  mote.done(Link::kRadio, true);
  EXPECT_EQ(mote.only_frame().type, am::kNet);
}

TEST(JoinStep, J4Repeat_RepeatThatWaitedTooLongIsForgotten) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  mote.hear(join_reply(5, {kIsland, 5}, 0, 1));
  mote.step(LinkBusy{Link::kRadio, true});
  mote.done(Link::kRadio, false);
  EXPECT_EQ(mote.labels(), (std::vector{followed("N2-QUEUE"_rule)}));
  mote.now = 501;
  mote.step(LinkBusy{Link::kRadio, false});
  EXPECT_EQ(mote.labels(), (std::vector{ignored("J4-REPEAT"_rule)}));
}

TEST(JoinStep, J8_WholeCallWithoutAnswer) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  for (Ticks expected = 500; expected <= 2000; expected += 500) {
    mote.join_timer();
    EXPECT_EQ(mote.now, expected);
    EXPECT_EQ(mote.labels(), (std::vector{sent("J8-RETRY"_rule)}));
    mote.done();
  }
  mote.join_timer();
  EXPECT_EQ(mote.labels(), (std::vector{notified("J8-FAIL"_rule)}));
  EXPECT_EQ(mote.now, 2500U);
  EXPECT_TRUE(timers(mote.state).empty());
  mote.call(JoinIsland{kDescriptor});
  EXPECT_EQ(mote.labels(), (std::vector{sent("J1-REQUEST"_rule)}));
  EXPECT_EQ(mote.state.join.seq_num, 2);  // J1-SEQ.
}

TEST(JoinStep, J1Seq_NotTheNumberOfTheCallBefore) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  for (int i = 0; i < 5; ++i) mote.join_timer().done();
  mote.state.sequence.last = static_cast<std::uint16_t>(mote.state.join.seq_num - 1);
  mote.call(JoinIsland{kDescriptor});
  EXPECT_EQ(mote.state.join.seq_num, 2);
}

TEST(JoinStep, J8Period_RequestThatWaitsStandsForTheNext) {
  Device mote(mote_config(5));
  mote.step(LinkBusy{Link::kRadio, true});
  mote.call(JoinIsland{kDescriptor});
  mote.join_timer();
  EXPECT_EQ(mote.labels(), (std::vector{followed("J8-PERIOD"_rule)}));
  EXPECT_EQ(mote.state.radio.out.size(), 1U);
  mote.now = 900;
  mote.step(LinkBusy{Link::kRadio, false});
  EXPECT_EQ(mote.only_frame().type, am::kJoin);
  EXPECT_EQ(mote.state.join.due, 1400U);  // A whole period from when it left.
}

TEST(JoinStep, J8_NothingLeavesAfterFail) {
  Device mote(mote_config(5));
  mote.step(LinkBusy{Link::kRadio, true});
  mote.call(JoinIsland{kDescriptor});
  for (int i = 0; i < 5; ++i) mote.join_timer();
  EXPECT_FALSE(mote.notice<Joined>().success);
  mote.step(LinkBusy{Link::kRadio, false});
  EXPECT_TRUE(mote.silent());
}

TEST(JoinStep, SinkListsAnnouncesAndReports) {
  Device sink(sink_config());
  sink.hear(join_request(5, 100, kDescriptor)).done();
  sink.hear(ack_join({kIsland, 1}, {kIsland, 5}, 100, kDescriptor));
  EXPECT_EQ(sink.labels(), (std::vector{notified("J6-ADD"_rule), sent("J6-REPORT"_rule)}));
  const Transmit& report = sink.only_frame();
  EXPECT_EQ(report.link, Link::kSerial);
  EXPECT_EQ(report.dest, kAmBroadcast);
  EXPECT_EQ(report.src, 0);
  EXPECT_EQ(sink.only_payload(), padded({0,  11, 0xFF, 0xFD, 0, 11, 0, 5,    0, 0, 0, 11, 3, 10,  //
                                         16, 0,  11,   0,    5, 1,  0, 0x43, 1}));
  sink.hear(ack_join({kIsland, 1}, {kIsland, 5}, 100, kDescriptor));
  EXPECT_EQ(sink.labels(), (std::vector{ignored("J6-REPEAT"_rule)}));
}

TEST(JoinStep, J3Address_NobodyHasAReservedIdOrTheSinks) {
  const std::uint16_t nobodys[] = {0xFFFF, 0xFFFE, 0xFFFD, 1};
  for (const std::uint16_t from : nobodys) {
    Device sink(sink_config());
    const State before = sink.state;
    sink.hear(join_request(from, 100, kDescriptor));
    EXPECT_EQ(sink.labels(), (std::vector{ignored("J3-ADDRESS"_rule)})) << from;
    EXPECT_EQ(sink.state, before);
  }
}

TEST(JoinStep, J4Address_OffersOfWhatTheMoteIsNot) {
  Device mote(mote_config(5));
  mote.call(JoinIsland{kDescriptor}).done();
  const State before = mote.state;
  const Address offers[] = {{kIsland, 6},       {kIsland, 0xFFFF}, {kIsland, kNullDevid},
                            {kBroadcastPid, 5}, {kLocalPid, 5},    {0xFFFD, 5}};
  for (const Address& offer : offers) {
    mote.hear(join_reply(5, offer, 0, mote.state.join.seq_num));
    EXPECT_EQ(mote.labels(), (std::vector{ignored("J4-ADDRESS"_rule)})) << offer.pid;
    EXPECT_EQ(mote.state, before);
  }
  mote.hear(join_reply(5, {kIsland, 5}, 0, mote.state.join.seq_num));
  EXPECT_EQ(mote.state.join.phase, Phase::kMember);
}

TEST(JoinStep, SinkAndBaseStationCannotJoin) {
  for (const Config& config : {sink_config(), base_config()}) {
    Device node(config);
    node.call(JoinIsland{kDescriptor});
    EXPECT_EQ(node.labels(), (std::vector{notified("J8-JOINED"_rule)}));
    EXPECT_FALSE(node.notice<Joined>().success);
  }
}

TEST(SynapticTick, EightOutputsAndEightInputsAtOnce) {
  Config config = sink_config();
  config.profile.channels_max = kChannelsRoom;
  Device sink(config);
  for (std::uint16_t devid = 2; devid < 2 + kChannelsRoom; ++devid) {
    const Address peer{kLocalPid, devid};
    sink.call(CreateChannel{Direction::kOut, peer, kConnectionsMax, Mode::kReliable});
    sink.call(CreateChannel{Direction::kIn, peer, kConnectionsMax, Mode::kReliable});
  }
  sink.call(StartAllChannels{});
  sink.now = sink.state.synaptic.due;
  sink.step(TimerDue{{TimerKind::kSynaptic, 0}});
  EXPECT_EQ(sink.actions.transmits().size(), 1U);
  EXPECT_EQ(sink.actions.notices().size(), kChannelsRoom);
  // One is being sent and four wait; the others find the buffer full.
  EXPECT_TRUE(sink.state.radio.out.full());
  std::size_t refused = 0;
  for (const Action& action : sink.actions.all()) {
    refused += action.requirement == "N1-FULL"_rule ? 1 : 0;
  }
  EXPECT_EQ(refused, kChannelsRoom - 5);
}

TEST(Timers, OneThatIsNotSetChangesNothing) {
  for (const Config& config : {sink_config(), mote_config(5), base_config()}) {
    for (const TimerKind kind : {TimerKind::kJoin, TimerKind::kAck, TimerKind::kSynaptic}) {
      Device node(config);
      const State before = node.state;
      node.step(TimerDue{{kind, 3}});
      EXPECT_TRUE(node.silent());
      EXPECT_EQ(node.actions.all().size(), 1U);
      EXPECT_EQ(node.state, before);
    }
  }
}

constexpr Ticks kLast = std::numeric_limits<Ticks>::max();

TEST(Ticks, ASecondIs1024OfThem) {
  EXPECT_EQ(ticks_of(1'000'000), 1024U);
  EXPECT_EQ(us_of(1024), 1'000'000);
  EXPECT_EQ(Profile{}.ticks_per_second, kTicksPerSecond);
}

TEST(Ticks, ATickHasBegunFromItsFirstMicrosecondOn) {
  EXPECT_EQ(ticks_of(976), 0U);  // A tick lasts 976.5625 microseconds.
  EXPECT_EQ(ticks_of(977), 1U);
  EXPECT_EQ(us_of(1), 977);
  EXPECT_EQ(us_of(500), 488'282);  // 488281.25
  EXPECT_EQ(us_of(512), 500'000);
}

TEST(Ticks, ThereAndBackIsTheSameTickUntilTheLast) {
  const auto same = [](Ticks ticks) {
    return ticks_of(us_of(ticks)) == ticks && (ticks == 0 || ticks_of(us_of(ticks) - 1) < ticks);
  };
  for (Ticks ticks = 0; ticks < 100'000; ++ticks) ASSERT_TRUE(same(ticks)) << ticks;
  for (Ticks ticks = kLast; ticks > kLast - 1000; --ticks) ASSERT_TRUE(same(ticks)) << ticks;
}

TEST(Ticks, TimesOfACaptureMayBeFarOff) {
  constexpr std::uint64_t kSeconds = 10'000'000'000;
  EXPECT_EQ(ticks_of(kSeconds * 1'000'000 + 977), static_cast<Ticks>(kSeconds * 1024 + 1));
}

TEST(Ticks, OtherUnitsAreCutOffToo) {
  EXPECT_EQ(ticks_of(1000, 1000), 1024U);
  EXPECT_EQ(ticks_of(1, 1000), 1U);    // 1.024
  EXPECT_EQ(ticks_of(41, 1000), 41U);  // 41.984
  EXPECT_EQ(ticks_of(42, 1000), 43U);  // 43.008
  EXPECT_EQ(ticks_of(777, 1024), 777U);
}

TEST(Ticks, WhatHoldsATimeIsRoundedUp) {
  EXPECT_EQ(ticks_to_hold(0), 0U);
  EXPECT_EQ(ticks_to_hold(1), 1U);
  EXPECT_EQ(ticks_to_hold(976), 1U);
  EXPECT_EQ(ticks_to_hold(977), 2U);
  EXPECT_EQ(ticks_to_hold(1'000'000), 1024U);
}

}  // namespace

}  // namespace rubric::machine
