// Operations on synaptic channels, and data that arrive. A test's name begins with its rule.
#include "conformance/machine/synaptic.h"

#include <gtest/gtest.h>

#include <vector>

namespace rubric::machine {
namespace {

// One node reduced to its synaptic part, for its tests.

constexpr Address kSink{11, 1};
constexpr Address kOwn{11, 2};
constexpr Address kPeer{11, 5};
constexpr ChannelId kToSink = 0x0002'0001;
constexpr ChannelId kFromPeer = 0x0005'0002;

struct Signal {
  ChannelId id;
  DataStatus status;
  friend bool operator==(const Signal&, const Signal&) = default;
};

/// Starts as mote 2 of island 11 at time 1000.
class SynapticTest : public testing::Test {
 protected:
  SynapticTest() { config_.id = kOwn.devid; }

  bool call(const Call& call) {
    actions_.clear();
    call_synaptic(synaptic_, config_, own_, now_, call, actions_);
    EXPECT_TRUE(actions_.transmits().empty());
    EXPECT_EQ(actions_.notices().size(), 1U);
    const Notice& notice = actions_.notices()[0];
    if (const auto* made = std::get_if<ChannelResult>(&notice)) {
      id_ = made->id;
      return made->success;
    }
    if (const auto* read = std::get_if<InputValue>(&notice)) {
      bits_ = bits_of_float(read->value);
      return read->success;
    }
    return std::get<OperationResult>(notice).success;
  }
  ReqId rule() const { return actions_.all().back().requirement; }
  bool create_out(std::uint8_t size, Mode mode = Mode::kReliable, Address peer = kSink) {
    return call(CreateChannel{Direction::kOut, peer, size, mode});
  }
  bool create_in(std::uint8_t size, Address peer = kPeer) {
    return call(CreateChannel{Direction::kIn, peer, size, Mode::kReliable});
  }
  bool write(ChannelId id, std::uint8_t pos, float value) {
    return call(WriteOutput{id, pos, value});
  }
  std::uint32_t read_bits(ChannelId id, std::uint8_t pos) {
    EXPECT_TRUE(call(ReadInput{id, pos}));
    return bits_;
  }
  // Lets the clock tick when it is due.
  std::vector<Signal> tick() {
    EXPECT_NE(synaptic_.due, 0U);
    now_ = synaptic_.due;
    sends_.clear();
    actions_.clear();
    tick_synaptic(synaptic_, own_, now_, sends_, actions_);
    std::vector<Signal> signals;
    for (const Notice& notice : actions_.notices()) {
      const auto& told = std::get<SynDataReceived>(notice);
      signals.push_back({told.id, told.status});
    }
    return signals;
  }
  void hear(Address src, const std::vector<std::uint32_t>& values, std::size_t cut_bytes = 0) {
    std::vector<std::uint8_t> bytes(values.size() * 4);
    for (std::size_t i = 0; i < values.size(); ++i) store_le32(bytes.data() + 4 * i, values[i]);
    actions_.clear();
    hear_synaptic(synaptic_, own_, src, Bytes(bytes.data(), bytes.size() - cut_bytes), actions_);
  }

  Config config_;
  Address own_ = kOwn;
  Synaptic synaptic_;
  Ticks now_ = 1000;
  Actions actions_;
  SynapticSends sends_;
  ChannelId id_ = 0;
  std::uint32_t bits_ = 0;
};

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

// The clock of synaptic channels. A test's name begins with its rule.

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

TEST_F(SynapticClock, S4_Local_WithoutInputNothingIsSent) {
  create_out(1, Mode::kReliable, kOwn);
  call(StartAllChannels{});
  EXPECT_TRUE(tick().empty());
  EXPECT_TRUE(sends_.empty());
  EXPECT_EQ(rule(), "S4-LOCAL"_rule);
}

}  // namespace
}  // namespace rubric::machine
