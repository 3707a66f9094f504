// Operations on synaptic channels, and data that arrive. A test's name begins with its rule.
#include "conformance/machine/test/synaptic_fixture.h"

namespace rubric::machine {
namespace {

TEST_F(SynapticTest, S1_Id_SourceAboveDestination) {
  EXPECT_TRUE(create_out(3));
  EXPECT_EQ(id_, kToSink);
  EXPECT_EQ(rule(), "S1-ID"_rule);
  EXPECT_TRUE(create_in(3));
  EXPECT_EQ(id_, kFromPeer);
}

TEST_F(SynapticTest, S1_Id_HoldsNoIsland) {
  EXPECT_TRUE(create_out(3));
  EXPECT_TRUE(create_in(3));
  const Synaptic before = synaptic_;
  EXPECT_FALSE(create_out(1, Mode::kReliable, {12, kSink.devid}));
  EXPECT_EQ(rule(), "S1-ID"_rule);
  EXPECT_FALSE(create_in(1, {12, kPeer.devid}));
  EXPECT_TRUE(synaptic_ == before);
  EXPECT_TRUE(create_in(1, {kLocalPid, kPeer.devid}));  // The same island by its other name.
  EXPECT_EQ(rule(), "S1-ENLARGE"_rule);
}

// Between two sinks both directions have one id: one call meets both. (decision 130)
TEST_F(SynapticTest, S1_Start_BothEndsOfOneId) {
  own_ = kSink;
  config_.role = Role::kSink;
  EXPECT_TRUE(create_out(1, Mode::kReliable, {12, 1}));
  const ChannelId out = id_;
  EXPECT_TRUE(create_in(1, {12, 1}));
  EXPECT_EQ(id_, out);
  EXPECT_TRUE(call(StartChannel{out}));
  EXPECT_EQ(rule(), "S1-START"_rule);
  EXPECT_TRUE(synaptic_.out[0].started && synaptic_.in[0].started);
  EXPECT_TRUE(call(StopChannel{out}));
  EXPECT_FALSE(synaptic_.out[0].started || synaptic_.in[0].started);
  EXPECT_TRUE(call(DisposeChannel{out}));
  EXPECT_TRUE(synaptic_.out.empty() && synaptic_.in.empty());
}

TEST_F(SynapticTest, S5_Unknown_SameMoteOfAnotherIsland) {
  create_in(1);
  create_in(1, {kLocalPid, 6});
  call(StartAllChannels{});
  const Synaptic before = synaptic_;
  for (const std::uint16_t devid : {kPeer.devid, std::uint16_t{6}}) {
    hear({12, devid}, {1});
    EXPECT_EQ(rule(), "S5-UNKNOWN"_rule);
    EXPECT_TRUE(synaptic_ == before);
    hear({11, devid}, {1});
    EXPECT_EQ(rule(), "S1-READ"_rule);
    synaptic_ = before;
  }
}

TEST_F(SynapticTest, S1_Enlarge_CreatingAgainAddsConnections) {
  EXPECT_TRUE(create_out(3));
  write(kToSink, 2, 1.5F);
  EXPECT_TRUE(create_out(4, Mode::kPowerSave));
  EXPECT_EQ(rule(), "S1-ENLARGE"_rule);
  EXPECT_EQ(id_, kToSink);
  ASSERT_EQ(synaptic_.out.size(), 1U);
  EXPECT_EQ(synaptic_.out[0].size, 7);
  EXPECT_EQ(synaptic_.out[0].mode, Mode::kReliable);
  EXPECT_EQ(synaptic_.out[0].value_bits[2], bits_of_float(1.5F));
  EXPECT_TRUE(write(kToSink, 6, 1));
  EXPECT_FALSE(write(kToSink, 7, 1));
}

TEST_F(SynapticTest, S1_Limit_TenConnections) {
  EXPECT_FALSE(create_out(11));
  EXPECT_EQ(rule(), "S1-LIMIT"_rule);
  EXPECT_FALSE(create_out(0));
  EXPECT_TRUE(synaptic_.out.empty());
  EXPECT_TRUE(create_out(6));
  EXPECT_FALSE(create_out(5));
  EXPECT_FALSE(create_out(255));
  EXPECT_EQ(synaptic_.out[0].size, 6);
  EXPECT_TRUE(create_out(4));
  EXPECT_EQ(synaptic_.out[0].size, 10);
}

TEST_F(SynapticTest, S1_Limit_FourChannelsOfEachDirection) {
  for (std::uint16_t devid = 10; devid < 14; ++devid) {
    EXPECT_TRUE(create_out(1, Mode::kReliable, {11, devid}));
    EXPECT_TRUE(create_in(1, {11, devid}));
  }
  const Synaptic before = synaptic_;
  EXPECT_FALSE(create_out(1, Mode::kReliable, {11, 14}));
  EXPECT_EQ(rule(), "S1-LIMIT"_rule);
  EXPECT_FALSE(create_in(1, {11, 14}));
  EXPECT_TRUE(synaptic_ == before);
  EXPECT_TRUE(create_in(1, {11, 13}));  // Enlarging needs no place.
}

TEST_F(SynapticTest, S1_Limit_AsManyChannelsAsTheNodeSays) {
  for (const int stated : {1, 2, 7, 8, 255}) {
    synaptic_ = {};
    config_.profile.channels_max = static_cast<std::uint8_t>(stated);
    std::size_t created = 0;
    for (std::uint16_t devid = 10; devid < 30; ++devid) {
      created += create_out(1, Mode::kReliable, {11, devid}) ? 1 : 0;
      EXPECT_EQ(create_in(1, {11, devid}), create_in(1, {11, devid})) << devid;
    }
    EXPECT_EQ(created, std::min(static_cast<std::size_t>(stated), kChannelsRoom)) << stated;
    EXPECT_EQ(synaptic_.in.size(), created);
    EXPECT_EQ(rule(), "S1-LIMIT"_rule);
  }
}

TEST_F(SynapticTest, S1_Write_RefusesWhatIsNotThere) {
  create_out(2);
  create_in(2);
  EXPECT_TRUE(write(kToSink, 1, 1));
  EXPECT_FALSE(write(kToSink, 2, 1));
  EXPECT_EQ(rule(), "S1-WRITE"_rule);
  EXPECT_FALSE(write(kFromPeer, 0, 1));  // An input.
  EXPECT_FALSE(write(0x0002'0063, 0, 1));
}

TEST_F(SynapticTest, S1_Read_RefusesWhatIsNotThere) {
  create_out(2);
  create_in(2);
  EXPECT_TRUE(call(ReadInput{kFromPeer, 1}));
  EXPECT_EQ(bits_, 0U);
  EXPECT_FALSE(call(ReadInput{kFromPeer, 2}));
  EXPECT_EQ(rule(), "S1-READ"_rule);
  EXPECT_FALSE(call(ReadInput{kToSink, 0}));  // An output.
}

TEST_F(SynapticTest, S1_Read_LatestDataBitForBit) {
  constexpr std::uint32_t kNan = 0xFF80'0001;  // A signalling NaN with a payload.
  create_in(3);
  call(StartAllChannels{});
  hear(kPeer, {1, 2, 3});
  hear(kPeer, {kNan, 0x8000'0000, 7});
  EXPECT_EQ(rule(), "S1-READ"_rule);
  EXPECT_EQ(read_bits(kFromPeer, 0), kNan);
  EXPECT_EQ(read_bits(kFromPeer, 1), 0x8000'0000U);
  EXPECT_EQ(read_bits(kFromPeer, 2), 7U);
}

TEST_F(SynapticTest, S1_Read_ShorterAndLongerDataTakeWhatBothHave) {
  create_in(2);
  call(StartAllChannels{});
  hear(kPeer, {1, 2, 3, 4});
  EXPECT_EQ(synaptic_.in[0].value_bits[1], 2U);
  EXPECT_EQ(synaptic_.in[0].value_bits[2], 0U);
  hear(kPeer, {9, 8}, 1);  // Seven bytes: one value and something.
  EXPECT_EQ(read_bits(kFromPeer, 0), 9U);
  EXPECT_EQ(read_bits(kFromPeer, 1), 2U);
  EXPECT_EQ(tick(), (std::vector<Signal>{{kFromPeer, DataStatus::kNew}}));
  hear(kPeer, {5}, 1);  // No whole value.
  EXPECT_EQ(read_bits(kFromPeer, 0), 9U);
  EXPECT_EQ(tick(), (std::vector<Signal>{{kFromPeer, DataStatus::kOld}}));
}

TEST_F(SynapticTest, S1_Clock_DefaultAndSet) {
  own_ = {11, 1};
  config_.role = Role::kSink;
  create_in(1);
  EXPECT_FALSE(call(SetTimeStep{0}));
  EXPECT_TRUE(call(SetTimeStep{200}));
  EXPECT_EQ(synaptic_.due, 0U);
  Synaptic unset;
  call_synaptic(unset, config_, own_, now_, CreateChannel{Direction::kIn, kPeer, 1, {}}, actions_);
  EXPECT_EQ(unset.period_ticks, config_.profile.synaptic_period_ticks);
  call(StartAllChannels{});
  EXPECT_EQ(synaptic_.due, now_ + 200);
  now_ += 50;
  EXPECT_TRUE(call(SetTimeStep{300}));
  EXPECT_EQ(rule(), "S1-CLOCK"_rule);
  EXPECT_EQ(synaptic_.due, now_ + 300);
  tick();
  EXPECT_EQ(synaptic_.due, now_ + 300);
}

TEST_F(SynapticTest, S5_Unknown_ReportedNotStored) {
  create_in(1);
  create_out(1, Mode::kReliable, {11, 9});
  call(StartAllChannels{});
  const Synaptic before = synaptic_;
  hear({11, 9}, {1});
  ASSERT_EQ(actions_.notices().size(), 1U);
  const auto& told = std::get<SynDataReceived>(actions_.notices()[0]);
  EXPECT_EQ(told.id, 0x0009'0002U);
  EXPECT_EQ(told.status, DataStatus::kUnknownChannel);
  EXPECT_EQ(rule(), "S5-UNKNOWN"_rule);
  EXPECT_TRUE(synaptic_ == before);
}

TEST_F(SynapticTest, S6_Stopped_NotStartedSendsSignalsStoresNothing) {
  create_out(1);
  create_out(1, Mode::kReliable, {11, 8});
  create_in(1);
  call(StartChannel{kToSink});
  hear(kPeer, {5});
  EXPECT_TRUE(actions_.notices().empty());
  EXPECT_EQ(rule(), "S6-STOPPED"_rule);
  EXPECT_TRUE(tick().empty());
  EXPECT_EQ(sends_.size(), 1U);
  EXPECT_EQ(read_bits(kFromPeer, 0), 0U);
}

TEST_F(SynapticTest, S6_Stopped_DataBeforeTheStopIsNotNewAfterTheNextStart) {
  create_out(1);
  create_in(1);
  call(StartAllChannels{});
  hear(kPeer, {5});
  EXPECT_TRUE(call(StopChannel{kFromPeer}));
  EXPECT_TRUE(tick().empty());
  call(StartChannel{kFromPeer});
  EXPECT_EQ(tick(), (std::vector<Signal>{{kFromPeer, DataStatus::kOld}}));
  EXPECT_EQ(read_bits(kFromPeer, 0), 5U);
}

TEST_F(SynapticTest, S6_Disposed_FreesItsPlaceAndOthersRunOn) {
  create_out(1);
  create_out(2, Mode::kReliable, {11, 8});
  call(StartAllChannels{});
  const Ticks due = synaptic_.due;
  EXPECT_TRUE(call(DisposeChannel{kToSink}));
  EXPECT_EQ(rule(), "S6-DISPOSED"_rule);
  EXPECT_EQ(synaptic_.due, due);
  tick();
  ASSERT_EQ(sends_.size(), 1U);
  EXPECT_EQ(sends_[0].dest.devid, 8);
  EXPECT_FALSE(call(DisposeChannel{kToSink}));
  EXPECT_FALSE(call(StartChannel{kToSink}));
  EXPECT_FALSE(call(StopChannel{kToSink}));
  EXPECT_FALSE(write(kToSink, 0, 1));
  EXPECT_TRUE(create_out(3));
  EXPECT_EQ(synaptic_.out[1].size, 3);  // Anew, not enlarged.
  EXPECT_FALSE(synaptic_.out[1].started);
}

TEST_F(SynapticTest, S6_Disposed_LastStartedChannelEndsTheClock) {
  create_in(1);
  call(StartAllChannels{});
  call(DisposeChannel{kFromPeer});
  EXPECT_EQ(synaptic_.due, 0U);
  hear(kPeer, {1});
  EXPECT_EQ(std::get<SynDataReceived>(actions_.notices()[0]).status, DataStatus::kUnknownChannel);
}

TEST_F(SynapticTest, S6_Others_StopOneStopAll) {
  create_out(1);
  create_out(1, Mode::kReliable, {11, 8});
  create_in(1);
  call(StartAllChannels{});
  EXPECT_TRUE(call(StopChannel{kToSink}));
  EXPECT_EQ(tick().size(), 1U);
  ASSERT_EQ(sends_.size(), 1U);
  EXPECT_EQ(sends_[0].dest.devid, 8);
  EXPECT_TRUE(call(StopAllChannels{}));
  EXPECT_EQ(rule(), "S1-ALL"_rule);
  EXPECT_EQ(synaptic_.due, 0U);
  EXPECT_TRUE(call(StopAllChannels{}));
}

TEST_F(SynapticTest, S6_Clock_RestartDoesNotShift) {
  create_out(1);
  create_in(1);
  call(StartAllChannels{});
  tick();
  const Ticks due = synaptic_.due;
  now_ += 100;
  call(StopChannel{kToSink});
  now_ += 100;
  call(StartChannel{kToSink});
  EXPECT_EQ(synaptic_.due, due);
  EXPECT_EQ(actions_.all()[0].requirement, "S6-CLOCK"_rule);
}

TEST_F(SynapticTest, StartAllOfNothingStartsNoClock) {
  EXPECT_TRUE(call(StartAllChannels{}));
  EXPECT_EQ(synaptic_.due, 0U);
}

}  // namespace
}  // namespace rubric::machine
