// The network level and the dispatcher in whole nodes: send, receive, forward, ack.

#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

using Payload = std::vector<std::uint8_t>;

constexpr std::uint8_t kOpenDoor[] = {0x0D, 0x0E};

OwnFrame on_radio(std::uint16_t am_dest, const NetFields& fields) {
  return {Link::kRadio, am_dest, fields.src.devid, am::kNet, net_msg(fields)};
}
OwnFrame on_serial(const NetFields& fields) {
  return {Link::kSerial, 1, 0, am::kNet, padded(net_msg(fields))};
}
OwnFrame on_peis(std::uint16_t island, const NetFields& fields) {
  return {Link::kPeis, island, fields.src.pid, am::kNet, net_msg(fields)};
}

TEST(Send, N1_MoteToMote) {
  Device mote = member(5);
  mote.call(Send{{kLocalPid, 6}, 10, false, kOpenDoor});
  EXPECT_EQ(mote.labels(), (std::vector{followed("N3-LOCAL"_rule), sent("N4-MOTE"_rule),
                                        notified("N1-SEQ"_rule)}));
  EXPECT_EQ(mote.only_frame().dest, 6);
  EXPECT_EQ(mote.only_frame().src, 5);
  EXPECT_EQ(mote.only_payload(),
            (Payload{0, 11, 0, 6, 0, 11, 0, 5, 0, 0, 2, 4, 3, 10, 0x0D, 0x0E}));
  EXPECT_EQ(mote.notice<SendResult>().seq_num, 2);
}

TEST(Send, BaseStationOverSerialAndPeis) {
  Device base(base_config());
  base.call(Send{{kIsland, 5}, 10, true, kOpenDoor});
  EXPECT_EQ(base.only_frame().link, Link::kSerial);
  EXPECT_EQ(base.only_frame().dest, 1);
  EXPECT_EQ(base.only_frame().src, 0);
  EXPECT_EQ(base.only_payload(),
            padded({0, 11, 0, 5, 0, 11, 0xFF, 0xFD, 1, 0, 1, 4, 3, 10, 0x0D, 0x0E}));
  base.call(Send{{kOther, kNullDevid}, 10, false, kOpenDoor});
  EXPECT_EQ(base.only_frame().link, Link::kPeis);
  EXPECT_EQ(base.only_frame().dest, kOther);
  EXPECT_EQ(base.only_frame().src, kIsland);
  EXPECT_EQ(base.only_payload().size(), 16U);
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

TEST(Send, N4Self_IsRefusedByEveryRole) {
  for (Device node : {member(5), Device(sink_config()), Device(base_config())}) {
    const State before = node.state;
    const std::uint16_t own = own_address(before).devid;
    for (const std::uint16_t pid : {kIsland, kLocalPid}) {
      for (const std::uint16_t devid : {own, kLocalDevid}) {
        node.call(Send{{pid, devid}, 10, true, kOpenDoor});
        EXPECT_EQ(node.labels(), (std::vector{notified("N4-SELF"_rule)}));
        EXPECT_EQ(node.notice<SendResult>().seq_num, kNoSeq);
        EXPECT_EQ(node.state, before);
      }
    }
    node.call(Send{{kOther, own}, 10, false, kOpenDoor});
    EXPECT_EQ(node.actions.transmits().size(), 1U);
  }
}

TEST(Send, J11_NoMemberNoMessage) {
  Device mote(mote_config(5));
  mote.call(Send{{kIsland, 6}, 10, false, {}});
  EXPECT_EQ(mote.labels(), (std::vector{notified("J11-SEND"_rule)}));
  EXPECT_EQ(mote.notice<SendResult>().seq_num, kNoSeq);
  mote.call(JoinIsland{kDescriptor}).done();
  EXPECT_EQ(mote.call(Send{{kIsland, 6}, 10, false, {}}).labels(),
            (std::vector{notified("J11-SEND"_rule)}));
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

// Another node sent in its name.
TEST(Receive, N4Self_NoAckToItself) {
  Device mote = member(5);
  mote.hear(on_radio(5, {{kIsland, 5}, {kIsland, 5}, true}));
  EXPECT_TRUE(mote.actions.transmits().empty());
  EXPECT_EQ(mote.labels().back(), ignored("N4-SELF"_rule));
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

TEST(Receive, FramesForAnotherAreNotHeard) {
  for (Device node : {member(5), Device(sink_config())}) {
    const State before = node.state;
    for (const std::uint8_t type : {am::kJoin, am::kJoinReply, am::kAckJoin, am::kNet}) {
      OwnFrame frame = on_radio(77, {{kIsland, kBroadcastDevid}, {kIsland, 6}});
      frame.type = type;
      EXPECT_EQ(node.hear(frame).labels(), (std::vector{ignored(ReqId::kNone)}));
    }
    EXPECT_EQ(node.state, before);
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

TEST(Forward, N6_UpTheSerialLineFilledWithZeros) {
  Device sink(sink_config());
  const NetFields fields{{kOther, 9}, {kIsland, 5}, true, 0x1234};
  sink.hear(on_radio(1, fields));
  EXPECT_EQ(sink.labels(), (std::vector{sent("N6-ROUTE"_rule)}));
  EXPECT_EQ(sink.only_frame().link, Link::kSerial);
  EXPECT_EQ(sink.only_frame().dest, kAmBroadcast);
  EXPECT_EQ(sink.only_payload(), padded(net_msg(fields)));
}

// Mote, sink, base station, PEIS, base station, sink, mote: and the ack the same way back.
TEST(Forward, N8_AcrossIslandsAndBack) {
  Device from = member(5), sink_a(sink_config()), base_a(base_config());
  Device base_b(base_config(kOther)), sink_b(sink_config(kOther)), to(mote_config(9));
  to.call(JoinIsland{kDescriptor}).done();
  to.hear(join_reply(9, {kOther, 9}, 0, 1)).done();
  from.call(Send{{kOther, 9}, 10, true, kOpenDoor});
  const std::uint16_t seq_num = from.notice<SendResult>().seq_num;
  const Transmit& sent_first = from.only_frame();
  to.hear(sink_b
              .hear(base_b.hear(base_a.hear(sink_a.hear(sent_first).only_frame()).only_frame())
                        .only_frame())
              .only_frame());
  const auto got = to.notice<Received>();
  EXPECT_EQ(got.src, (Address{kIsland, 5}));
  EXPECT_EQ(Payload(got.data.begin(), got.data.end()), (Payload{0x0D, 0x0E}));
  from.hear(
      sink_a
          .hear(base_a.hear(base_b.hear(sink_b.hear(to.only_frame()).only_frame()).only_frame())
                    .only_frame())
          .only_frame());
  EXPECT_EQ(from.notice<AckReceived>().seq_num, seq_num);
  EXPECT_TRUE(from.notice<AckReceived>().success);
}

TEST(Forward, PeisOfAnotherIslandIsNotHeard) {
  Device base(base_config());
  EXPECT_EQ(base.hear(on_peis(kOther, {{kOther, 5}, {13, 1}})).labels(),
            (std::vector{ignored(ReqId::kNone)}));
  EXPECT_EQ(base.hear(on_peis(kIsland, {{kOther, 5}, {13, 1}})).labels(),
            (std::vector{ignored("N8-LOOP"_rule)}));
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

TEST(Synaptic, J11Send_NoDataWithoutMembership) {
  Device mote(mote_config(2));
  mote.call(CreateChannel{Direction::kOut, {kLocalPid, 1}, 1, Mode::kReliable});
  mote.call(StartAllChannels{});
  mote.step(TimerDue{{TimerKind::kSynaptic, 0}});
  EXPECT_EQ(mote.labels(), (std::vector{ignored("J11-SEND"_rule)}));
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

TEST(IslandId, N9Other_OtherConfigChangesNothing) {
  Device sink(sink_config());
  list_member(sink, 5);
  const State before = sink.state;
  for (int code = 0; code < 256; ++code) {
    if (code == 10) continue;
    sink.hear(config(static_cast<std::uint8_t>(code), kOther));
    EXPECT_EQ(sink.labels(), (std::vector{ignored("N9-OTHER"_rule)}));
  }
  OwnFrame cut = set_island_id(kOther);
  cut.payload.pop_back();
  EXPECT_EQ(sink.hear(cut).labels(), (std::vector{ignored("WIRE-CONFIG"_rule)}));
  EXPECT_EQ(sink.state, before);
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

TEST(IslandId, BaseStationTellsItsSink) {
  Device base(base_config());
  base.call(SetIslandId{12});
  const Transmit& frame = base.only_frame();
  EXPECT_EQ(frame.link, Link::kSerial);
  EXPECT_EQ(frame.dest, 1);
  EXPECT_EQ(frame.src, 0);
  EXPECT_EQ(frame.type, 37);
  EXPECT_EQ(base.only_payload(), (Payload{0x0A, 0x00, 0x0C}));  // The original sends it so.
  EXPECT_TRUE(base.notice<OperationResult>().success);
  EXPECT_EQ(own_address(base.state), (Address{12, kNullDevid}));
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
