// Awaited acks, messages to be acked, and sequence numbers. A test's name begins with its rule.
#include "conformance/machine/transport.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace rubric::machine {
namespace {

constexpr Address kMote4{11, 4};
constexpr Address kPc{11, kNullDevid};
constexpr Address kAll{11, 0xFFFF};
constexpr Address kEveryIsland{0xFFFF, 4};
constexpr std::uint8_t kControl = 10;
constexpr std::uint8_t kMockup = 5;

// Adds a reliable message that the line took at once.
void sent(AwaitedList& list, const Profile& profile, Ticks now, std::uint16_t seq_num,
          std::uint8_t app_id, Address dest) {
  await_ack(list, seq_num, app_id, dest);
  start_ack_timer(list, profile, now, seq_num);
}

struct AckCase {
  const char* name;
  Address dest;           // In the message.
  Address from;           // In the ack.
  std::uint8_t app_id;    // In the ack; the message's is kControl.
  std::uint16_t seq_num;  // In the ack; the message's is 100.
  ReqId requirement;
};

const AckCase kAcks[] = {
    {"T3_Success", kMote4, kMote4, kControl, 100, "T3-SUCCESS"_rule},
    {"T3_Success_BaseStation", kPc, kPc, kControl, 100, "T3-SUCCESS"_rule},
    {"T3_Match_OtherNumber", kMote4, kMote4, kControl, 101, "T3-MATCH"_rule},
    {"T3_Match_Swapped", kMote4, kMote4, kControl, 0x6400, "T3-MATCH"_rule},
    {"T3_Sender_OtherMote", kMote4, {11, 5}, kControl, 100, "T3-SENDER"_rule},
    {"T3_Sender_OtherIsland", kMote4, {12, 4}, kControl, 100, "T3-SENDER"_rule},
    {"T3_Sender_OtherApp", kMote4, kMote4, kMockup, 100, "T3-SENDER"_rule},
    {"T3_Sender_OfBroadcast", kAll, kMote4, kControl, 100, "T3-SENDER"_rule},
    {"T3_Sender_OfBroadcastForged", kAll, kAll, kControl, 100, "T3-SENDER"_rule},
    {"T3_Sender_OfAllIslandsForged", kEveryIsland, kEveryIsland, kControl, 100, "T3-SENDER"_rule},
};

class HearAck : public testing::TestWithParam<AckCase> {};

TEST_P(HearAck, CountsOrChangesNothing) {
  const AckCase& c = GetParam();
  AwaitedList list;
  sent(list, Profile{}, 50, 100, kControl, c.dest);
  const AwaitedList before = list;
  Actions actions;
  hear_ack(list, c.from, c.app_id, c.seq_num, actions);
  ASSERT_EQ(actions.all().size(), 1U);
  EXPECT_EQ(actions.all()[0].requirement, c.requirement);
  EXPECT_TRUE(actions.transmits().empty());
  if (c.requirement != "T3-SUCCESS"_rule) {
    EXPECT_TRUE(actions.notices().empty());
    EXPECT_EQ(actions.all()[0].what, Action::What::kIgnored);
    EXPECT_TRUE(list == before);
    return;
  }
  EXPECT_TRUE(list.empty());
  const auto& told = std::get<AckReceived>(actions.notices()[0]);
  EXPECT_EQ(told.app_id, kControl);
  EXPECT_EQ(told.seq_num, 100);
  EXPECT_TRUE(told.success);
}

INSTANTIATE_TEST_SUITE_P(Transport, HearAck, testing::ValuesIn(kAcks),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(Awaited, T3_Timeout_IsFailureAfterTheProfilesTime) {
  AwaitedList list;
  Profile profile{.ack_timeout_ticks = 640};
  sent(list, profile, 1000, 7, kControl, kMote4);
  EXPECT_EQ(list[0].due, 1640U);
  Actions actions;
  ack_timeout(list, 0, actions);
  ASSERT_EQ(actions.notices().size(), 1U);
  const auto& told = std::get<AckReceived>(actions.notices()[0]);
  EXPECT_EQ(told.app_id, kControl);
  EXPECT_EQ(told.seq_num, 7);
  EXPECT_FALSE(told.success);
  EXPECT_EQ(actions.all()[0].requirement, "T3-TIMEOUT"_rule);
  EXPECT_TRUE(list.empty());
}

TEST(Awaited, T3_Timeout_NoneInAProfileWithout) {
  AwaitedList list;
  Profile profile{.ack_timeout_ticks = 0};
  sent(list, profile, 1000, 7, kControl, kMote4);
  EXPECT_EQ(list[0].due, 0U);
}

TEST(Awaited, FullListKeepsWhatItHas) {
  AwaitedList list;
  for (std::uint16_t i = 0; i < kAwaitedMax + 1; ++i) sent(list, Profile{}, 0, i, kControl, kMote4);
  EXPECT_EQ(list.size(), kAwaitedMax);
  EXPECT_FALSE(is_awaited(list, kAwaitedMax));
  EXPECT_TRUE(is_awaited(list, 0));
}

TEST(Sequence, N12_Reuse_CountingSkipsAwaitedNumbers) {
  AwaitedList list;
  sent(list, Profile{}, 0, 6, kControl, kMote4);
  sent(list, Profile{}, 0, 7, kControl, kMote4);
  sent(list, Profile{}, 0, 9, kControl, kMote4);
  Sequence sequence{5, false};
  EXPECT_EQ(next_seq_num(sequence, list), 8);
  EXPECT_EQ(next_seq_num(sequence, list), 10);
}

TEST(Sequence, N12_RandomVisitsEverythingButTheErrorValueAndZero) {
  Sequence sequence{1, true};
  const AwaitedList none;
  std::set<std::uint16_t> seen;
  for (int i = 0; i < 65534; ++i) seen.insert(next_seq_num(sequence, none));
  EXPECT_EQ(seen.size(), 65534U);
  EXPECT_EQ(seen.count(kNoSeq), 0U);
}

TEST(Sequence, N12_RandomLeavesZero) {
  Sequence sequence{0, true};
  const AwaitedList none;
  const std::uint16_t first = next_seq_num(sequence, none);
  EXPECT_NE(first, 0);
  EXPECT_NE(next_seq_num(sequence, none), first);
}

struct BodyCase {
  const char* name;
  std::vector<std::uint8_t> body;
  std::int32_t seq_num;
};

std::vector<std::uint8_t> with_stale(std::vector<std::uint8_t> body) {
  body.resize(kAppDataMax, 0xEE);
  return body;
}

const BodyCase kBodies[] = {
    {"T2_Content_Paper", {0x12, 0x34}, 0x1234},
    {"T2_Content_Deployed", {23, 0x12, 0x34, 0}, 0x1234},
    {"T2_Content_DeployedCode", {23, 0xFF, 0xFE, 1}, 0xFFFE},
    {"T2_Content_DeployedStale", with_stale({23, 0x12, 0x34, 0}), 0x1234},
    {"T2_Content_PaperStale", with_stale({0x12, 0x34}), 0x1234},
    {"T2_Content_Empty", {}, -1},
    {"T2_Content_OneByte", {23}, -1},
    {"T2_Content_DeployedCut", {23, 0x12, 0x34}, -1},
    {"T2_Content_OtherType", {24, 0x12, 0x34, 0}, -1},
};

class AckedNumber : public testing::TestWithParam<BodyCase> {};
TEST_P(AckedNumber, IsRead) {
  const BodyCase& c = GetParam();
  EXPECT_EQ(acked_seq_num(Bytes(c.body.data(), c.body.size())), c.seq_num);
}
INSTANTIATE_TEST_SUITE_P(Transport, AckedNumber, testing::ValuesIn(kBodies),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace rubric::machine
