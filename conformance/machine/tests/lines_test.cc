// Buffers of both lines, and switching the interfaces.
#include "conformance/machine/lines.h"

#include "conformance/machine/tests/machine_fixture.h"

namespace rubric::machine {
namespace {

Send message(std::uint8_t mark) {
  static std::uint8_t marks[256];
  marks[mark] = mark;
  return {{kIsland, 6}, 10, false, {marks + mark, 1}};
}
std::uint8_t mark_of(const Transmit& frame) { return frame.payload[14]; }

OwnFrame heard(std::uint8_t mark, std::uint16_t id = 5) {
  return {Link::kRadio, id, 6, am::kNet,
          net_msg({{kIsland, id}, {kIsland, 6}, false, 1, {3, 10, mark}})};
}
OwnFrame heard_on_serial(std::uint8_t mark) {
  return {Link::kSerial, 1, 0, am::kNet,
          padded(net_msg({{kIsland, 1}, {kIsland, kNullDevid}, false, 1, {3, 10, mark}}))};
}

// Returns marks of what the application got in the last step.
std::vector<std::uint8_t> received(const Device& node) {
  std::vector<std::uint8_t> marks;
  for (const Notice& notice : node.actions.notices()) {
    if (const auto* got = std::get_if<Received>(&notice)) marks.push_back(got->data[0]);
  }
  return marks;
}

TEST(Outgoing, N2_WaitsWhileSendingAndLeavesInOrder) {
  Device mote = member(5);
  mote.call(message(1));
  for (std::uint8_t mark = 2; mark <= 5; ++mark) {
    mote.call(message(mark));
    EXPECT_EQ(mote.labels(), (std::vector{followed("N2-QUEUE"_rule), notified("N1-SEQ"_rule)}));
  }
  for (std::uint8_t mark = 2; mark <= 5; ++mark) {
    mote.done();
    EXPECT_EQ(mote.labels(), (std::vector{sent("N4-MOTE"_rule), followed("N2-ORDER"_rule)}));
    EXPECT_EQ(mark_of(mote.only_frame()), mark);
  }
  EXPECT_TRUE(mote.done().silent());
}

TEST(Outgoing, SerialHoldsTwo) {
  Device base(base_config());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NE(base.call(message(1)).notice<SendResult>().seq_num, kNoSeq);
  }
  EXPECT_EQ(base.call(message(1)).notice<SendResult>().seq_num, kNoSeq);
  EXPECT_EQ(base.labels(), (std::vector{notified("N1-FULL"_rule)}));
  EXPECT_FALSE(base.call(SetIslandId{12}).notice<OperationResult>().success);
  EXPECT_EQ(base.state.island, kIsland);
}

TEST(Outgoing, J6Report_WaitsUntilTheLineIsOn) {
  Device sink(sink_config());
  sink.call(SetInterface{Link::kSerial, false});
  sink.hear(join_request(5, 100, kDescriptor)).done();
  sink.hear(ack_join({kIsland, 1}, {kIsland, 5}, 100, kDescriptor));
  EXPECT_EQ(sink.labels(), (std::vector{notified("J6-ADD"_rule), followed("J6-REPORT"_rule)}));
  EXPECT_NE(find_member(sink.state.sink, 5), nullptr);
  sink.call(SetInterface{Link::kSerial, true});
  EXPECT_EQ(sink.only_frame().type, am::kNet);
}

TEST(Outgoing, J6Report_OfAnOldIslandIsForgotten) {
  Device sink(sink_config());
  OwnFrame up = heard(1, 1);
  up.payload = net_msg({{kIsland, kNullDevid}, {kIsland, 5}});
  for (int i = 0; i < 3; ++i) sink.hear(up);
  sink.hear(join_request(6, 100, kDescriptor)).done();
  sink.hear(ack_join({kIsland, 1}, {kIsland, 6}, 100, kDescriptor));
  EXPECT_EQ(sink.state.sink.unreported.size(), 1U);
  sink.hear(set_island_id(kOther));
  EXPECT_TRUE(sink.state.sink.unreported.empty());
  sink.done(Link::kSerial).done(Link::kSerial).done(Link::kSerial);
  EXPECT_TRUE(sink.silent());
}

// The time of a reliable message begins when the line has it.
TEST(Outgoing, T3Timeout_WaitingForTheRadioDoesNotCount) {
  Device mote = member(5);
  mote.step(LinkBusy{Link::kRadio, true});
  mote.now = 100;
  mote.call(Send{{kIsland, 6}, 10, true, {}});
  const std::uint16_t seq_num = mote.notice<SendResult>().seq_num;
  EXPECT_TRUE(timers(mote.state).empty());
  mote.now = 1100;
  mote.step(TimerDue{{TimerKind::kAck, 0}});
  EXPECT_EQ(mote.labels(), (std::vector{ignored("T3-ONCE"_rule)}));
  mote.now = 5000;
  EXPECT_EQ(mote.step(LinkBusy{Link::kRadio, false}).only_frame().type, am::kNet);
  ASSERT_EQ(timers(mote.state).size(), 1U);
  EXPECT_EQ(timers(mote.state)[0].due, 6000U);
  mote.now = 6000;
  mote.step(TimerDue{{TimerKind::kAck, 0}});
  EXPECT_EQ(mote.notice<AckReceived>().seq_num, seq_num);
  EXPECT_FALSE(mote.notice<AckReceived>().success);
}

TEST(Outgoing, SendDoneOfNothingIsIgnored) {
  Device mote = member(5);
  const State before = mote.state;
  for (const Link link : {Link::kRadio, Link::kSerial, Link::kPeis}) {
    EXPECT_EQ(mote.done(link).labels(), (std::vector{ignored(ReqId::kNone)}));
  }
  EXPECT_EQ(mote.state, before);
}

TEST(Incoming, N2InOrder_WaitsWhileTheApplicationIsBusy) {
  Device mote = member(5);
  mote.step(AppBusy{true});
  for (std::uint8_t mark = 1; mark <= 4; ++mark) {
    EXPECT_EQ(mote.hear(heard(mark)).labels(), (std::vector{followed("N2-IN-ORDER"_rule)}));
  }
  EXPECT_EQ(mote.hear(heard(5)).labels(), (std::vector{ignored("N2-IN-FULL"_rule)}));
  mote.step(AppBusy{false});
  EXPECT_EQ(received(mote), (std::vector<std::uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(mote.labels()[0], followed("N2-IN-ORDER"_rule));
  EXPECT_EQ(received(mote.hear(heard(6))), (std::vector<std::uint8_t>{6}));
}

TEST(Incoming, PeisDoesNotWait) {
  Device base(base_config());
  base.step(AppBusy{true});
  OwnFrame frame{Link::kPeis, kIsland, kOther, am::kNet,
                 net_msg({{kIsland, kNullDevid}, {kOther, 4}, false, 1, {3, 10, 8}})};
  EXPECT_EQ(received(base.hear(frame)), (std::vector<std::uint8_t>{8}));
}

TEST(Control, N10_OffSendsAndHearsNothing) {
  Device mote = member(5);
  EXPECT_TRUE(mote.call(GetInterface{Link::kRadio}).notice<InterfaceState>().on);
  EXPECT_TRUE(mote.call(SetInterface{Link::kRadio, false}).notice<OperationResult>().success);
  EXPECT_FALSE(mote.call(GetInterface{Link::kRadio}).notice<InterfaceState>().on);
  EXPECT_TRUE(mote.call(GetInterface{Link::kSerial}).notice<InterfaceState>().on);
  EXPECT_EQ(mote.call(message(1)).labels(), (std::vector{notified("N10-OFF"_rule)}));
  EXPECT_EQ(mote.notice<SendResult>().seq_num, kNoSeq);
  EXPECT_EQ(mote.hear(heard(1)).labels(), (std::vector{ignored("N10-OFF"_rule)}));
  mote.call(SetInterface{Link::kRadio, true});
  EXPECT_EQ(mote.labels(), (std::vector{notified("N10-ON"_rule)}));
  EXPECT_EQ(received(mote.hear(heard(2))), (std::vector<std::uint8_t>{2}));
  EXPECT_EQ(mark_of(mote.call(message(3)).only_frame()), 3);
}

TEST(Control, LinesThatANodeDoesNotHave) {
  Device base(base_config());
  EXPECT_FALSE(base.call(SetInterface{Link::kRadio, true}).notice<OperationResult>().success);
  EXPECT_FALSE(base.call(GetInterface{Link::kRadio}).notice<InterfaceState>().on);
  EXPECT_FALSE(base.call(SetInterface{Link::kPeis, false}).notice<OperationResult>().success);
  EXPECT_TRUE(base.call(GetInterface{Link::kPeis}).notice<InterfaceState>().on);
  Device mote(mote_config(5));
  EXPECT_FALSE(mote.call(GetInterface{Link::kPeis}).notice<InterfaceState>().on);
  EXPECT_EQ(mote.hear(heard_on_serial(1)).labels(), (std::vector{ignored(ReqId::kNone)}));
}

TEST(Queue, EraseKeepsTheOrderOfTheOthers) {
  for (std::size_t turned = 0; turned < 4; ++turned) {
    for (std::size_t out = 0; out < 4; ++out) {
      BoundedQueue<int, 4> queue;
      for (std::size_t i = 0; i < turned; ++i) queue.push() = -1, queue.pop();
      for (int i = 0; i < 4; ++i) queue.push() = i;
      queue.erase(out);
      queue.push() = 4;
      std::vector<int> left;
      for (std::size_t i = 0; i < queue.size(); ++i) left.push_back(queue[i]);
      std::vector<int> expected = {0, 1, 2, 3, 4};
      expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(out));
      EXPECT_EQ(left, expected);
    }
  }
}

// A frame that has not left has no answer: a number may be guessed, or from before a reboot.
TEST(Outgoing, J4_NoRequestOutstandingBeforeItLeaves) {
  Device mote(mote_config(5));
  mote.step(LinkBusy{Link::kRadio, true});
  mote.call(JoinIsland{kDescriptor});
  const std::uint16_t seq_num = mote.state.join.seq_num;
  mote.hear(join_reply(5, {kIsland, 5}, 0, seq_num));
  EXPECT_EQ(mote.labels(), std::vector{ignored("J4-JOINED"_rule)});
  mote.step(LinkBusy{Link::kRadio, false}).done();
  mote.hear(join_reply(5, {kIsland, 5}, 0, seq_num));
  EXPECT_TRUE(mote.notice<Joined>().success);
}

}  // namespace
}  // namespace rubric::machine
