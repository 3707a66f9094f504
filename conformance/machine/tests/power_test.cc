// A node that loses its memory, or its power.
#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

// Numbers continue: a reply to a request from before must not fit the request after.
TEST(Reboot, J4Seq_ReplyToARequestOfBeforeIsIgnored) {
  for (const bool powered_off : {false, true}) {
    Device mote(mote_config(5));
    mote.call(JoinIsland{kDescriptor}).done();
    const OwnFrame late = join_reply(5, {kIsland, 5}, 0, mote.state.join.seq_num);
    if (powered_off) mote.step(PowerOff{});
    mote.step(Reboot{}).call(JoinIsland{kDescriptor}).done();
    EXPECT_EQ(mote.hear(late).labels(), (std::vector{ignored("J4-SEQ"_rule)}));
    EXPECT_EQ(mote.state.join.phase, JoinMote::Phase::kJoining);
  }
}

TEST(PowerOff, NothingHasAnEffectUntilReboot) {
  Device mote = member(5);
  mote.call(CreateChannel{Direction::kOut, {kIsland, 1}, 1, Mode::kReliable});
  mote.call(StartAllChannels{});
  mote.call(Send{{kIsland, 1}, 10, true, {}});
  mote.step(AppBusy{true});
  mote.step(PowerOff{});
  EXPECT_TRUE(mote.silent());
  EXPECT_TRUE(timers(mote.state).empty());
  State off = start(mote_config(5));
  off.off = true;
  off.sequence = mote.state.sequence;
  EXPECT_EQ(mote.state, off);
  const auto nothing = [&] {
    EXPECT_TRUE(mote.silent());
    ASSERT_EQ(mote.actions.all().size(), 1U);
    EXPECT_EQ(mote.actions.all()[0].requirement, "N10-OFF"_rule);
    EXPECT_EQ(mote.actions.all()[0].what, Action::What::kIgnored);
    EXPECT_EQ(mote.state, off);
  };
  mote.done();
  nothing();
  mote.hear(join_reply(5, {kIsland, 5}, 0, 1));
  nothing();
  mote.call(JoinIsland{kDescriptor});
  nothing();
  mote.call(Send{{kIsland, 1}, 10, false, {}});
  nothing();
  mote.call(SetInterface{Link::kRadio, true});
  nothing();
  mote.step(TimerDue{{TimerKind::kJoin, 0}});
  nothing();
  mote.step(TimerDue{{TimerKind::kSynaptic, 0}});
  nothing();
  mote.step(AppBusy{true});
  nothing();
  mote.step(PowerOff{});
  nothing();
  mote.now = 2048;
  mote.step(Reboot{});
  EXPECT_FALSE(mote.state.off);
  EXPECT_EQ(mote.call(GetClock{}).notice<Clock>().ms, 0U);
  EXPECT_EQ(mote.call(JoinIsland{kDescriptor}).only_frame().type, am::kJoin);
}

}  // namespace
}  // namespace rubric::machine
