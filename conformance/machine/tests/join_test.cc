// The join protocol as parts, without a node around them.
#include "conformance/machine/join.h"

#include <gtest/gtest.h>

#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

using Phase = JoinMote::Phase;
constexpr Address kOffer{kIsland, 5};

class MoteJoin : public testing::Test {
 protected:
  JoinContext context() const { return {profile_, 5, 0, 0, now_}; }
  JoinSend call(std::uint16_t seq_num = 100) {
    return clear(), call_join(join_, context(), kDescriptor, seq_num, actions_);
  }
  JoinSend reply(std::uint16_t seq_num = 100, Address offer = kOffer) {
    return clear(), hear_reply(join_, context(), offer, seq_num, 1, actions_);
  }
  JoinSend timer() {
    now_ = join_.due;
    return clear(), join_timer(join_, context(), actions_);
  }
  JoinSend sent(bool acked) { return clear(), ack_join_sent(join_, context(), acked, actions_); }
  ReqId rule(Action::What what) const {
    EXPECT_EQ(actions_.all().size(), 1U);
    if (actions_.all().empty()) return ReqId::kNone;
    EXPECT_EQ(actions_.all()[0].what, what);
    return actions_.all()[0].requirement;
  }
  ReqId ignored_by() const { return rule(Action::What::kIgnored); }
  ReqId told_by() const { return rule(Action::What::kNotify); }
  Joined notified() const { return std::get<Joined>(actions_.notices()[0]); }
  void clear() { actions_.clear(); }

  Profile profile_;
  JoinMote join_;
  Ticks now_ = 1000;
  Actions actions_;
};

TEST_F(MoteJoin, J8_DeployedSendsSevenAndSaysNothing) {
  profile_.join_requests_max = 7;
  profile_.join_fail_signalled = false;
  call();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(timer(), JoinSend::kRequest);
  EXPECT_EQ(timer(), JoinSend::kNone);
  EXPECT_EQ(rule(Action::What::kFollowed), "J8-LIMIT"_rule);
  EXPECT_EQ(join_.phase, Phase::kOutside);
}

TEST_F(MoteJoin, J5Stop_TimerAfterAcceptanceDoesNothing) {
  call();
  reply();
  const JoinMote before = join_;
  now_ += 500;
  clear();
  EXPECT_EQ(join_timer(join_, context(), actions_), JoinSend::kNone);
  EXPECT_EQ(ignored_by(), "J5-STOP"_rule);
  EXPECT_EQ(join_, before);
}

TEST_F(MoteJoin, J5Once_CallWhileJoiningEndsAtOnceAndDisturbsNothing) {
  call();
  const JoinMote before = join_;
  EXPECT_EQ(call(101), JoinSend::kNone);
  EXPECT_EQ(told_by(), "J5-ONCE"_rule);
  EXPECT_FALSE(notified().success);
  EXPECT_EQ(join_, before);
}

TEST_F(MoteJoin, J4Repeat_NotAfterThePeriod) {
  call();
  reply();
  now_ += 500;
  EXPECT_EQ(sent(false), JoinSend::kAck);
  now_ += 1;
  EXPECT_EQ(sent(false), JoinSend::kNone);
  EXPECT_EQ(rule(Action::What::kFollowed), "J4-REPEAT"_rule);
}

class SinkJoin : public testing::Test {
 protected:
  JoinContext context() const { return {profile_, 1, kIsland, 0, 0}; }
  bool request(std::uint16_t mote, std::uint16_t seq_num, Descriptor what = kDescriptor) {
    actions_.clear();
    return hear_request(sink_, context(), mote, seq_num, what, actions_);
  }
  bool ack(std::uint16_t mote, std::uint16_t seq_num, std::uint16_t island = kIsland) {
    actions_.clear();
    return hear_ack_join(sink_, context(), {island, 1}, {island, mote}, seq_num, kDescriptor,
                         actions_);
  }
  void join(std::uint16_t mote, std::uint16_t seq_num) {
    EXPECT_TRUE(request(mote, seq_num));
    EXPECT_TRUE(ack(mote, seq_num));
  }
  ReqId ignored_by() const {
    EXPECT_EQ(actions_.all().size(), 1U);
    if (actions_.all().empty()) return ReqId::kNone;
    EXPECT_EQ(actions_.all()[0].what, Action::What::kIgnored);
    return actions_.all()[0].requirement;
  }

  Profile profile_;
  JoinSink sink_;
  Actions actions_;
};

TEST_F(SinkJoin, J6Seq_OnlyTheNumberStoredLast) {
  request(5, 100);
  request(5, 101);
  EXPECT_EQ(sink_.pending.size(), 1U);
  EXPECT_FALSE(ack(5, 100));
  EXPECT_EQ(ignored_by(), "J6-SEQ"_rule);
  EXPECT_TRUE(ack(5, 101));
}

TEST_F(SinkJoin, J2_DeployedAnswersAndCountsANewJoin) {
  profile_.listed_ignored = false;
  join(5, 100);
  const Descriptor other{3, 0, 1};
  EXPECT_TRUE(request(5, 101, other));
  EXPECT_FALSE(ack(5, 100));  // The number of the join before.
  EXPECT_TRUE(ack(5, 101));
  EXPECT_EQ(sink_.members.size(), 1U);
  EXPECT_EQ(*find_member(sink_, 5), (Admission{5, 101, other}));
  EXPECT_FALSE(ack(5, 101));
  EXPECT_EQ(ignored_by(), "J6-REPEAT"_rule);
}

TEST_F(SinkJoin, J3Overwrite_LateAckFindsNoPlace) {
  profile_.members_max = 2;
  join(2, 2);
  EXPECT_TRUE(request(3, 3));
  EXPECT_TRUE(request(4, 4));
  EXPECT_TRUE(ack(4, 4));
  EXPECT_FALSE(ack(3, 3));
  EXPECT_EQ(ignored_by(), "J3-OVERWRITE"_rule);
  EXPECT_NE(find_member(sink_, 2), nullptr);
  EXPECT_NE(find_member(sink_, 4), nullptr);
  EXPECT_EQ(find_member(sink_, 3), nullptr);
}

TEST_F(SinkJoin, J9_OldestPendingGivesWayButNoMember) {
  join(2, 2);
  for (std::uint16_t mote = 10; mote < 30; ++mote) EXPECT_TRUE(request(mote, mote));
  EXPECT_TRUE(sink_.pending.full());
  EXPECT_TRUE(request(10, 99));  // Asks again: the newest now.
  EXPECT_TRUE(request(50, 50));
  EXPECT_EQ(find_pending(sink_, 11), nullptr);
  EXPECT_NE(find_pending(sink_, 10), nullptr);
  EXPECT_NE(find_pending(sink_, 50), nullptr);
  EXPECT_NE(find_member(sink_, 2), nullptr);
  EXPECT_EQ(sink_.pending.size(), 20U);
}

}  // namespace
}  // namespace rubric::machine
