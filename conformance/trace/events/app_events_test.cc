// Calls and news survive the conversion to a trace's words and back.
#include <gtest/gtest.h>

#include "conformance/trace/events/lines.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::events {
namespace {

trace::Concrete parsed(const std::string& text) {
  trace::Message message;
  EXPECT_EQ(trace::parse_message(text, message), "") << text;
  return trace::concrete(message);
}

class CallText : public testing::TestWithParam<const char*> {};
class NoticeText : public testing::TestWithParam<const char*> {};

TEST_P(CallText, ReadsBackWhatItWrites) {
  const trace::Concrete message = parsed(GetParam());
  const auto call = to_call(message);
  ASSERT_TRUE(call);
  EXPECT_EQ(trace::print(from_call(*call)), GetParam());
}
INSTANTIATE_TEST_SUITE_P(
    All, CallText,
    testing::Values("join(type=telosb_demo transducers=light|temp actuators=led)",
                    "send(dest=11:5 app_id=mockup reliable=1 data=x0102)",
                    "interface(link=radio on=off)", "get_interface(link=serial)",
                    "create_out(dest=11:1 size=3 mode=power_save)",
                    "create_in(src=11:2 size=10 mode=reliable)", "dispose(channel=2->1)",
                    "start(channel=2->1)", "stop(channel=2->1)", "start_all()", "stop_all()",
                    "write_output(channel=2->1 pos=2 value=0.5)", "read_input(channel=2->1 pos=9)",
                    "set_time_step(clock=250)", "set_island_id(island=12)", "get_clock()"));

TEST_P(NoticeText, ReadsBackWhatItWrites) {
  const trace::Concrete message = parsed(GetParam());
  const auto notice = to_notice(message);
  ASSERT_TRUE(notice);
  EXPECT_EQ(trace::print(from_notice(*notice)), GetParam());
}
INSTANTIATE_TEST_SUITE_P(
    All, NoticeText,
    testing::Values("joined(address=11:5 result=success)",
                    "mote_joined(address=11:5 type=micaz_demo transducers=pir actuators=open)",
                    "send_result(seq_num=65535)",
                    "received(src=11:1 app_id=control_layer data=x0a)",
                    "ack_received(app_id=mockup seq_num=9 result=fail)",
                    "syn_data(channel=2->1 status=old)",
                    "channel_result(channel=2->1 result=success)", "op_result(result=fail)",
                    "input_value(value=-2.25 result=success)", "interface_state(link=radio on=on)",
                    "clock(ms=70000)"));

TEST(ToCall, KnowsCallsFromNews) {
  EXPECT_FALSE(to_call(parsed("joined(11:5 success)")));
  EXPECT_FALSE(to_notice(parsed("stop_all")));
}

TEST(ToState, KnowsWhatIsBusy) {
  const trace::Concrete busy = parsed("busy");
  const auto app = to_state(busy, trace::LinkKind::kApp);
  ASSERT_TRUE(app);
  EXPECT_TRUE(std::get<machine::AppBusy>(*app).busy);
  const auto radio = to_state(parsed("idle"), trace::LinkKind::kRadio);
  ASSERT_TRUE(radio);
  EXPECT_FALSE(std::get<machine::LinkBusy>(*radio).busy);
  const auto done = to_state(parsed("linkack(acked=0)"), trace::LinkKind::kRadio);
  ASSERT_TRUE(done);
  EXPECT_FALSE(std::get<machine::SendDone>(*done).acked);
  const auto off = to_state(parsed("off"), trace::LinkKind::kPower);
  ASSERT_TRUE(off);
  EXPECT_TRUE(std::holds_alternative<machine::PowerOff>(*off));
  const auto on = to_state(parsed("reboot"), trace::LinkKind::kPower);
  ASSERT_TRUE(on);
  EXPECT_TRUE(std::holds_alternative<machine::Reboot>(*on));
  EXPECT_FALSE(to_state(parsed("joined(11:5 success)"), trace::LinkKind::kApp));
}

}  // namespace
}  // namespace rubric::events
