// The network level and the dispatcher in whole nodes: send, receive, forward, ack.

#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

using Payload = std::vector<std::uint8_t>;

OwnFrame on_radio(std::uint16_t am_dest, const NetFields& fields) {
  return {Link::kRadio, am_dest, fields.src.devid, am::kNet, net_msg(fields)};
}
OwnFrame on_serial(const NetFields& fields) {
  return {Link::kSerial, 1, 0, am::kNet, padded(net_msg(fields))};
}

TEST(Send, LargestGoesAndLargerIsRefused) {
  Device mote = member(5);
  const Payload data(101, 0x5A);
  mote.call(Send{{kIsland, 6}, 10, false, {data.data(), 100}}).step(SendDone{});
  EXPECT_EQ(mote.state.radio.sending, false);
  mote.call(Send{{kIsland, 6}, 10, false, {data.data(), 101}});
  EXPECT_TRUE(mote.actions.transmits().empty());
  EXPECT_EQ(mote.notice<SendResult>().seq_num, kNoSeq);
  EXPECT_EQ(mote.labels(), (std::vector{notified("N1-SIZE"_rule)}));
  mote.call(Send{{kIsland, 6}, 10, false, {data.data(), 100}});
  EXPECT_EQ(mote.only_payload().size(), 114U);
}

TEST(Send, T4_EightAwaitedAndTheNinthRefused) {
  Device mote = member(5);
  for (int i = 0; i < 8; ++i) {
    mote.call(Send{{kIsland, 6}, 10, true, {}});
    EXPECT_NE(mote.notice<SendResult>().seq_num, kNoSeq);
    mote.done();
  }
  mote.call(Send{{kIsland, 6}, 10, true, {}});
  EXPECT_EQ(mote.notice<SendResult>().seq_num, kNoSeq);
  EXPECT_TRUE(mote.actions.transmits().empty());
  mote.call(Send{{kIsland, 6}, 10, false, {}});
  EXPECT_NE(mote.notice<SendResult>().seq_num, kNoSeq);
}

TEST(Send, WithoutAckTimeoutTheOldestIsGivenUp) {
  Config config = mote_config(5);
  config.profile.ack_timeout_ticks = 0;
  Device mote = member(5, &config);
  for (int i = 0; i < 20; ++i) {
    mote.call(Send{{kIsland, 6}, 10, true, {}});
    EXPECT_NE(mote.notice<SendResult>().seq_num, kNoSeq);
    mote.done();
  }
  EXPECT_TRUE(timers(mote.state).empty());
  EXPECT_EQ(mote.state.awaited.size(), 8U);
  EXPECT_EQ(mote.state.awaited[0].seq_num, mote.state.sequence.last - 7);
  EXPECT_EQ(mote.state.awaited[7].seq_num, mote.state.sequence.last);
  mote.step(TimerDue{{TimerKind::kAck, 0}});
  EXPECT_TRUE(mote.silent());
}

// A sink delivers by its devid what came by serial for another island's sink; it does not ack it.
TEST(Receive, T2Ack_NotForAnotherIslandsSink) {
  Device sink(sink_config());
  sink.hear(on_serial({{kOther, 1}, {13, kNullDevid}, true}));
  EXPECT_EQ(sink.notice<Received>().src, (Address{13, kNullDevid}));
  EXPECT_TRUE(sink.actions.transmits().empty());
  sink.hear(on_serial({{kIsland, 1}, {13, kNullDevid}, true}));
  EXPECT_EQ(sink.only_frame().link, Link::kSerial);
}

TEST(Receive, T1_UnknownIsDropped) {
  Device mote = member(5);
  const Payload kUnknown[] = {{3, 99, 1}, {99, 10, 1}, {0, 0}, {2, 10}, {8, 10}};
  for (const Payload& payload : kUnknown) {
    mote.hear(on_radio(5, {{kIsland, 5}, {kIsland, 6}, true, 1, payload}));
    EXPECT_EQ(mote.labels(),
              (std::vector{followed("N5-DELIVER"_rule), ignored("T1-UNKNOWN"_rule)}));
  }
}

TEST(Receive, T2Loop_ReliableAckIsNotAcked) {
  Device mote = member(5);
  mote.hear(on_radio(5, {{kIsland, 5}, {kIsland, 6}, true, 9, {9, 10, 23, 0, 77, 0}}));
  EXPECT_TRUE(mote.silent());
  EXPECT_EQ(mote.labels(), (std::vector{followed("N5-DELIVER"_rule), ignored("T3-MATCH"_rule),
                                        followed("T2-LOOP"_rule)}));
  mote.hear(on_radio(5, {{kIsland, 5}, {kIsland, 6}, false, 9, {9, 10, 23}}));
  EXPECT_EQ(mote.labels(),
            (std::vector{followed("N5-DELIVER"_rule), ignored("WIRE-RUBICON-ACK"_rule)}));
}

TEST(Receive, N11_MalformedIsDroppedAndTheNextIsHandled) {
  struct Case {
    const char* name;
    std::size_t offset;
    std::uint8_t value;
    std::size_t size;
    ReqId rule;
  };
  const Case kCases[] = {{"Nbytes1", 11, 1, 15, "N11-NBYTES"_rule},
                         {"Nbytes0", 11, 0, 15, "N11-NBYTES"_rule},
                         {"Nbytes103", 11, 103, 114, "N11-NBYTES"_rule},
                         {"Nbytes255", 11, 255, 114, "N11-NBYTES"_rule},
                         {"OneMoreThanArrived", 11, 4, 15, "N11-NBYTES"_rule},
                         {"HeaderOnly", 11, 3, 12, "N11-NBYTES"_rule},
                         {"HeaderCut", 0, 0, 11, "N11-NBYTES"_rule},
                         {"Empty", 0, 0, 0, "N11-NBYTES"_rule},
                         {"Reliable2", 8, 2, 15, "WIRE-NET-RELIABLE"_rule}};
  for (Device node : {member(5), Device(sink_config())}) {
    const std::uint16_t id = node.state.config.id;
    for (const Case& each : kCases) {
      SCOPED_TRACE(each.name);
      OwnFrame frame = on_radio(id, {{kIsland, id}, {kIsland, 6}, true});
      frame.payload[each.offset] = each.value;
      frame.payload.resize(each.size);
      const State before = node.state;
      EXPECT_EQ(node.hear(frame).labels(), (std::vector{ignored(each.rule)}));
      EXPECT_EQ(node.state, before);
      node.hear(on_radio(id, {{kIsland, id}, {kIsland, 6}, true}));
      EXPECT_EQ(node.notice<Received>().data.size(), 1U);
      node.done();
    }
  }
}

TEST(Receive, UnknownAmTypesAreIgnored) {
  for (Device node : {member(5), Device(sink_config()), Device(base_config())}) {
    const bool base = node.state.config.role == Role::kBaseStation;
    for (int type = 0; type < 256; ++type) {
      if (type == 14 || type == 15 || type == 28 || type == 29) continue;
      OwnFrame frame = on_radio(kAmBroadcast, {{kIsland, kBroadcastDevid}, {kIsland, 6}});
      frame.link = base ? Link::kSerial : Link::kRadio;
      frame.type = static_cast<std::uint8_t>(type);
      EXPECT_EQ(node.hear(frame).labels(), (std::vector{ignored(ReqId::kNone)})) << type;
    }
  }
}

TEST(Synaptic, DataOfATickAndItsReception) {
  Device mote = member(2);
  Device sink(sink_config());
  mote.call(CreateChannel{Direction::kOut, {kLocalPid, 1}, 1, Mode::kReliable});
  const ChannelId id = mote.notice<ChannelResult>().id;
  mote.call(WriteOutput{id, 0, 1.0F});
  mote.call(StartAllChannels{});
  ASSERT_EQ(timers(mote.state).size(), 1U);
  mote.now = timers(mote.state)[0].due;
  EXPECT_EQ(mote.now, 530U);
  mote.step(TimerDue{{TimerKind::kSynaptic, 0}});
  EXPECT_EQ(mote.labels(), (std::vector{followed("N3-LOCAL"_rule), sent("S2-SEND"_rule)}));
  EXPECT_EQ(mote.only_payload(),
            (Payload{0, 11, 0, 1, 0, 11, 0, 2, 0, 0, 2, 6, 1, 11, 0, 0, 0x80, 0x3F}));
  sink.call(CreateChannel{Direction::kIn, {kIsland, 2}, 1, Mode::kReliable});
  sink.call(StartAllChannels{});
  sink.hear(mote.only_frame());
  EXPECT_EQ(sink.call(ReadInput{id, 0}).notice<InputValue>().value, 1.0F);
}

TEST(Synaptic, S3Changed_ChangeSurvivesARadioThatIsOff) {
  Device mote = member(2);
  mote.call(CreateChannel{Direction::kOut, {kIsland, 1}, 1, Mode::kPowerSave})
      .call(StartAllChannels{});
  const auto tick = [&mote] {
    mote.now = mote.state.synaptic.due;
    mote.step(TimerDue{{TimerKind::kSynaptic, 0}});
    return mote.actions.transmits().size();
  };
  EXPECT_EQ(tick(), 1U);
  mote.done();
  mote.call(WriteOutput{0x0002'0001, 0, 1.5F});
  mote.call(SetInterface{Link::kRadio, false});
  EXPECT_EQ(tick(), 0U);
  EXPECT_EQ(mote.labels(), (std::vector{ignored("N10-OFF"_rule)}));
  mote.call(SetInterface{Link::kRadio, true});
  EXPECT_EQ(tick(), 1U);
  EXPECT_EQ(mote.labels(), (std::vector{sent("S3-CHANGED"_rule)}));
  mote.done();
  EXPECT_EQ(tick(), 0U);  // Notified once.
  EXPECT_EQ(mote.labels(), (std::vector{followed("S3-UNCHANGED"_rule)}));
}

TEST(Synaptic, BaseStationHasNone) {
  Device base(base_config());
  EXPECT_FALSE(base.call(CreateChannel{Direction::kOut, {kIsland, 2}, 1, Mode::kReliable})
                   .notice<ChannelResult>()
                   .success);
  EXPECT_FALSE(base.call(ReadInput{}).notice<InputValue>().success);
  EXPECT_FALSE(base.call(StartAllChannels{}).notice<OperationResult>().success);
  base.hear(on_serial({{kIsland, kNullDevid}, {kIsland, 2}, false, 1, {1, 11, 0, 0, 0, 0}}));
  EXPECT_EQ(base.labels(), (std::vector{followed("N8-DELIVER"_rule), ignored("T1-UNKNOWN"_rule)}));
}

TEST(IslandId, SameIslandKeepsMembers) {
  Device sink(sink_config());
  list_member(sink, 5);
  EXPECT_EQ(sink.hear(set_island_id(kIsland)).labels(), (std::vector{followed("N9-SET"_rule)}));
  EXPECT_NE(find_member(sink.state.sink, 5), nullptr);
}

TEST(IslandId, N9Other_ReservedIslandsAreNotTaken) {
  constexpr std::uint16_t kReserved[] = {0xFFFD, 0xFFFE, 0xFFFF};
  for (const std::uint16_t island : kReserved) {
    Device sink(sink_config());
    list_member(sink, 5);
    const State before = sink.state;
    EXPECT_EQ(sink.hear(set_island_id(island)).labels(), (std::vector{ignored("N9-OTHER"_rule)}));
    EXPECT_EQ(sink.state, before);
    Device base(base_config());
    base.call(SetIslandId{island});
    EXPECT_EQ(base.labels(), (std::vector{notified("N9-OTHER"_rule)}));
    EXPECT_FALSE(base.notice<OperationResult>().success);
    EXPECT_EQ(base.state.island, kIsland);
  }
  Device sink(sink_config());
  EXPECT_EQ(sink.hear(set_island_id(0xFFFC)).labels()[0], followed("N9-SET"_rule));
}

TEST(IslandId, NobodyElseMayTell) {
  for (const Config& config : {sink_config(), mote_config(5)}) {
    Device node(config);
    node.call(SetIslandId{kOther});
    EXPECT_FALSE(node.notice<OperationResult>().success);
    EXPECT_NE(own_address(node.state).pid, kOther);
  }
}

}  // namespace

}  // namespace rubric::machine
