// The clock of synaptic channels. A test's name begins with its rule.
#include "conformance/machine/test/synaptic_fixture.h"

namespace rubric::machine {
namespace {

using SynapticClock = SynapticTest;

struct PhaseCase {
  Role role;
  std::uint16_t devid;
  Ticks phase;
};

TEST_F(SynapticClock, S2_Phase_OfMotesOnly) {
  const PhaseCase cases[] = {{Role::kMote, 2, 30},          {Role::kMote, 4, 90},
                             {Role::kMote, 1, 0},           {Role::kMote, 0, 0},
                             {Role::kMote, 60000, 1799970}, {Role::kSink, 7, 0}};
  for (const PhaseCase& c : cases) {
    synaptic_ = {};
    config_.role = c.role;
    own_.devid = c.devid;
    create_out(1);
    call(StartChannel{id_});
    EXPECT_EQ(synaptic_.due, now_ + c.phase + 500) << c.devid;
  }
}

TEST_F(SynapticClock, S2_Phase_StaysWhenTheStepIsSetBeforeTheFirstTick) {
  own_.devid = 4;
  create_out(1);
  call(StartChannel{id_});
  now_ += 50;
  call(SetTimeStep{200});
  EXPECT_EQ(synaptic_.due, now_ + 90 + 200);
  tick();
  EXPECT_EQ(synaptic_.due, now_ + 200);
  now_ += 50;
  call(SetTimeStep{300});
  EXPECT_EQ(synaptic_.due, now_ + 300);
  call(StopAllChannels{});
  call(StartAllChannels{});
  EXPECT_EQ(synaptic_.due, now_ + 90 + 300);
}

TEST_F(SynapticClock, S2_Send_EveryTickUnchangedOrNot) {
  create_out(3);
  write(kToSink, 0, 1.0F);
  write(kToSink, 2, -2.5F);
  EXPECT_TRUE(call(StartChannel{kToSink}));
  EXPECT_EQ(rule(), "S1-START"_rule);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(tick().empty());
    ASSERT_EQ(sends_.size(), 1U);
    EXPECT_EQ(sends_[0].dest, kSink);
    EXPECT_EQ(sends_[0].size, 3);
    EXPECT_EQ(sends_[0].requirement, "S2-SEND"_rule);
    EXPECT_EQ(sends_[0].value_bits[0], bits_of_float(1.0F));
    EXPECT_EQ(sends_[0].value_bits[1], 0U);
    EXPECT_EQ(sends_[0].value_bits[2], bits_of_float(-2.5F));
  }
}

TEST_F(SynapticClock, S2_Send_NanKeepsItsBits) {
  create_out(1);
  const std::uint32_t nan_bits = 0x7FC0'1234;
  write(kToSink, 0, float_of_bits(nan_bits));
  call(StartAllChannels{});
  tick();
  EXPECT_EQ(sends_[0].value_bits[0], nan_bits);
}

TEST_F(SynapticClock, S2_Tick_PeriodApartWhateverIsStarted) {
  create_out(1);
  create_in(1);
  call(StartChannel{kToSink});
  const Ticks first = synaptic_.due;
  tick();
  EXPECT_EQ(synaptic_.due, first + 500);
  now_ += 200;
  call(StartChannel{kFromPeer});
  EXPECT_EQ(synaptic_.due, first + 500);
  tick();
  EXPECT_EQ(synaptic_.due, first + 1000);
}

TEST_F(SynapticClock, S2_Tick_WithoutClockNothingHappens) {
  create_out(1);
  actions_.clear();
  tick_synaptic(synaptic_, own_, now_, sends_, actions_);
  EXPECT_TRUE(sends_.empty() && actions_.notices().empty());
  EXPECT_EQ(synaptic_.due, 0U);
}

TEST_F(SynapticClock, S2_Signal_NewThenOld) {
  create_in(1);
  EXPECT_TRUE(call(StartChannel{kFromPeer}));
  EXPECT_EQ(rule(), "S1-START"_rule);
  EXPECT_EQ(tick(), (std::vector<Signal>{{kFromPeer, DataStatus::kOld}}));
  EXPECT_EQ(rule(), "S3-OLD"_rule);
  hear(kPeer, {42});
  EXPECT_TRUE(actions_.notices().empty());  // Notified at the tick, not before.
  hear(kPeer, {43});
  EXPECT_EQ(tick(), (std::vector<Signal>{{kFromPeer, DataStatus::kNew}}));
  EXPECT_EQ(rule(), "S2-SIGNAL"_rule);
  EXPECT_EQ(tick(), (std::vector<Signal>{{kFromPeer, DataStatus::kOld}}));
  EXPECT_EQ(read_bits(kFromPeer, 0), 43U);  // S3-OLD: the values stay.
}

TEST_F(SynapticClock, S3_PowerSave_SendsChangesOnly) {
  create_out(2, Mode::kPowerSave);
  call(StartChannel{kToSink});
  tick();
  ASSERT_EQ(sends_.size(), 1U);  // The first tick always.
  EXPECT_EQ(sends_[0].requirement, "S3-CHANGED"_rule);
  tick();
  EXPECT_TRUE(sends_.empty());
  EXPECT_EQ(actions_.all()[0].requirement, "S3-UNCHANGED"_rule);
  write(kToSink, 1, 3.0F);
  tick();
  ASSERT_EQ(sends_.size(), 1U);
  EXPECT_EQ(sends_[0].size, 2);  // One change sends all.
  write(kToSink, 1, 3.0F);
  tick();
  EXPECT_TRUE(sends_.empty());  // Written, not changed.
}

TEST_F(SynapticClock, S3_PowerSave_ComparesBits) {
  create_out(1, Mode::kPowerSave);
  call(StartChannel{kToSink});
  const float nan_value = float_of_bits(0x7FC0'0000);
  write(kToSink, 0, nan_value);
  tick();
  write(kToSink, 0, nan_value);
  tick();
  EXPECT_TRUE(sends_.empty());
  write(kToSink, 0, 0.0F);
  tick();
  write(kToSink, 0, -0.0F);
  tick();
  EXPECT_EQ(sends_.size(), 1U);
}

TEST_F(SynapticClock, S3_PowerSave_FirstTickAfterEachStart) {
  create_out(1, Mode::kPowerSave);
  for (int i = 0; i < 2; ++i) {
    call(StartChannel{kToSink});
    tick();
    EXPECT_EQ(sends_.size(), 1U);
    call(StartChannel{kToSink});  // It is started, so nothing changes.
    tick();
    EXPECT_TRUE(sends_.empty());
    call(StopChannel{kToSink});
  }
}

TEST_F(SynapticClock, S4_Local_HandsOverWithoutSending) {
  create_out(3, Mode::kReliable, kOwn);
  create_in(2, kOwn);
  EXPECT_EQ(id_, kLocal);
  write(kLocal, 0, 1.0F);
  write(kLocal, 1, 2.0F);
  write(kLocal, 2, 3.0F);
  call(StartChannel{kLocal});  // Both ends.
  EXPECT_EQ(read_bits(kLocal, 0), 0U);
  EXPECT_EQ(tick(), (std::vector<Signal>{{kLocal, DataStatus::kNew}}));
  EXPECT_TRUE(sends_.empty());
  EXPECT_EQ(read_bits(kLocal, 1), bits_of_float(2.0F));
  EXPECT_EQ(tick(), (std::vector<Signal>{{kLocal, DataStatus::kNew}}));
}

TEST_F(SynapticClock, S4_Local_PowerSaveHandsOverChangesOnly) {
  create_out(1, Mode::kPowerSave, {kLocalPid, kOwn.devid});
  create_in(1, kOwn);
  call(StartAllChannels{});
  EXPECT_EQ(tick(), (std::vector<Signal>{{kLocal, DataStatus::kNew}}));
  EXPECT_EQ(tick(), (std::vector<Signal>{{kLocal, DataStatus::kOld}}));
  EXPECT_TRUE(sends_.empty());
}

TEST_F(SynapticClock, S4_Local_WithoutInputNothingIsSent) {
  create_out(1, Mode::kReliable, kOwn);
  call(StartAllChannels{});
  EXPECT_TRUE(tick().empty());
  EXPECT_TRUE(sends_.empty());
  EXPECT_EQ(rule(), "S4-LOCAL"_rule);
}

TEST_F(SynapticClock, S3_Changed_RefusedChangeGoesWithTheNextTick) {
  create_out(1, Mode::kPowerSave);
  create_out(1, Mode::kPowerSave, {11, 8});
  call(StartAllChannels{});
  tick();
  ASSERT_EQ(sends_.size(), 2U);
  keep_change(synaptic_, sends_[1].id);
  tick();
  ASSERT_EQ(sends_.size(), 1U);
  EXPECT_EQ(sends_[0].dest.devid, 8);
  tick();
  EXPECT_TRUE(sends_.empty());
}

// Its id is that of the channel to itself, but the other end is elsewhere.
TEST_F(SynapticClock, S4_Local_InputFromAnotherIslandTakesNothing) {
  create_out(1, Mode::kReliable, kOwn);
  create_in(1, {12, kOwn.devid});
  EXPECT_EQ(id_, kLocal);
  write(kLocal, 0, 1.0F);
  call(StartAllChannels{});
  EXPECT_EQ(tick(), (std::vector<Signal>{{kLocal, DataStatus::kOld}}));
  EXPECT_EQ(read_bits(kLocal, 0), 0U);
}

TEST_F(SynapticClock, S4_SinkOfAnotherIslandIsNotLocal) {
  own_ = kSink;
  config_.role = Role::kSink;
  create_out(1, Mode::kReliable, {12, 1});
  call(StartAllChannels{});
  tick();
  ASSERT_EQ(sends_.size(), 1U);
  EXPECT_EQ(sends_[0].dest, (Address{12, 1}));
}

}  // namespace
}  // namespace rubric::machine
