#include "conformance/test/targets/rct_answer.h"

#include <gtest/gtest.h>

#include "conformance/trace/print.h"

namespace rubric::targets {
namespace {

using runner::TargetBroken;

constexpr const char* kHex = "000001000506000e03e802000701";

Asked until() { return {.command = "until 300", .from = 100, .to = 300, .passes_time = true}; }
Asked call() {
  Asked asked{.command = "call 100 get_clock()"};
  asked.from = asked.to = 100;
  return asked;
}

// Returns what is wrong with an answer; empty if it is complete and right.
std::string wrong_with(const Asked& asked, const std::vector<std::string>& lines) {
  AnswerReader reader(asked);
  try {
    for (const std::string& line : lines) {
      if (reader.take(line)) return {};
    }
  } catch (const TargetBroken& error) {
    return error.what();
  }
  return "not closed";
}

TEST(RctAnswer, IsRead) {
  const Asked asked = until();
  AnswerReader reader(asked);
  EXPECT_FALSE(reader.take("note here it comes"));
  EXPECT_FALSE(reader.take(std::string("tx 120 radio ") + kHex + " linkack [J1 J1-REQUEST]"));
  EXPECT_FALSE(reader.take("tx 120 serial 000001000506000E03E802000701"));
  EXPECT_FALSE(reader.take("up 120 received(src=11:5 app_id=3 data=x0a0b) [T1-DELIVER]"));
  EXPECT_FALSE(reader.take("up 120 joined(11:5 success)"));
  EXPECT_FALSE(reader.take("next 500"));
  EXPECT_TRUE(reader.take("done 120"));
  const Answer& answer = reader.answer();
  ASSERT_EQ(answer.outputs.size(), 4U);
  const machine::Transmit& frame = answer.outputs[0].frame;
  EXPECT_TRUE(answer.outputs[0].is_frame && frame.link_ack);
  EXPECT_EQ(frame.link, machine::Link::kRadio);
  EXPECT_EQ(frame.dest, 1);
  EXPECT_EQ(frame.src, 5);
  EXPECT_EQ(frame.type, 0x0E);
  EXPECT_EQ(frame.size_bytes, 6);
  EXPECT_EQ(answer.outputs[0].requirement, "J1-REQUEST"_rule);
  EXPECT_FALSE(answer.outputs[1].frame.link_ack);
  EXPECT_EQ(answer.outputs[1].frame.link, machine::Link::kSerial);
  EXPECT_TRUE(equal(answer.outputs[1].frame.bytes(), frame.bytes()));
  EXPECT_EQ(trace::print(answer.outputs[2].news), "received(src=11:5 app_id=connless data=x0a0b)");
  EXPECT_EQ(answer.outputs[2].requirement, "T1-DELIVER"_rule);
  EXPECT_EQ(trace::print(answer.outputs[3].news), "joined(address=11:5 result=success)");
  EXPECT_TRUE(answer.has_next);
  EXPECT_EQ(answer.next, 500U);
  EXPECT_EQ(answer.done, 120U);
  EXPECT_EQ(answer.notes, std::vector<std::string>{"here it comes"});
}

TEST(RctAnswer, KeepsAFewNotesAndCountsTheRest) {
  const Asked asked = until();
  AnswerReader reader(asked);
  const std::string note = "note " + std::string(1018, 'x');  // With its line feed 1 KiB.
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(reader.take(note));
  EXPECT_EQ(reader.answer().notes.size(), 64U);
  EXPECT_EQ(reader.answer().notes_left_out, 936U);
}

TEST(RctAnswer, NothingHappens) {
  EXPECT_EQ(wrong_with(until(), {"next -", "done 300"}), "");
  EXPECT_EQ(wrong_with(until(), {"done 300"}), "");
  EXPECT_EQ(wrong_with(call(), {"up 100 clock(0)", "next 100", "done 100"}), "");
}

TEST(RctAnswer, Unsupported) {
  const Asked asked = call();
  AnswerReader reader(asked);
  try {
    reader.take("unsupported there is no clock");
    ADD_FAILURE();
  } catch (const runner::Unsupported& error) {
    EXPECT_STREQ(error.what(), "`call 100 get_clock()`: there is no clock");
  }
}

struct Bad {
  std::vector<std::string> lines;
  const char* wrong;  ///< After "line N of the answer to `until 300`: ".
};
const Bad kBad[] = {
    {{"done"}, "'' is not a time in ticks"},
    {{"done 1e3"}, "'1e3' is not a time in ticks"},
    {{"done -1"}, "'-1' is not a time in ticks"},
    {{"done 300 ok"}, "'ok' is too much"},
    {{"done 299"}, "done at 299, expected 300"},
    {{"done 301"}, "done at 301, expected 300"},
    {{"done 90"}, "done at 90, when 100 has passed"},
    {{"Done 300"}, "expected tx, up, next, note or `done`, given 'Done 300'"},
    {{"ready"}, "expected tx, up, next, note or `done`, given 'ready'"},
    {{" done 300"}, "expected tx, up, next, note or `done`, given ' done 300'"},
    {{"note \x07"}, "byte 0x07 at column 6 is not printable ASCII in 'note \\x07'"},
    {{"next soon"}, "'soon' is not a time in ticks"},
    {{"next 5 6"}, "'6' is too much"},
    {{"next 200", "done 300"}, "next at 200, which is before 300"},
    {{"tx 99 radio 00"}, "its time is 99, and 100 has passed"},
    {{"tx 301 radio 00"}, "its time is 301, to come after 300"},
    {{"tx 120 air 00"}, "'air' is not a link: radio, serial or peis"},
    {{"tx 120 radio"}, "'' is not an even number of hex digits"},
    {{"tx 120 radio 000"}, "'000' is not an even number of hex digits"},
    {{"tx 120 radio 0x00"}, "'0x00' is not an even number of hex digits"},
    {{"tx 120 radio 0000"},
     "'0000' is not a packet: 00, destination, source, length, group, type, payload"},
    {{"tx 120 radio 000001000507000e03e802000701"},
     "'000001000507000e03e802000701' is not a packet: 00, destination, source, length, group, "
     "type, "
     "payload"},
    {{"tx 120 radio 000001000506000e03e802000701 ack"},
     "expected `linkack` or the end after the frame, given 'ack'"},
    {{"tx 120 serial 000001000506000e03e802000701 linkack"},
     "only frames by radio ask for the radio's acknowledgement"},
    {{"tx 120 radio 000001000506000e03e802000701 [J99-NONE]"},
     "'J99-NONE' is not a rule of the catalogue"},
    {{"up 120 exploded(1)"}, "'exploded(1)': 'exploded' is not a message of an application"},
    {{"up 120 joined(11:5)"}, "'joined(11:5)': field result of joined is missing"},
    {{"up 120 joined"}, "'joined': 'joined' needs its fields"},
    {{"up 120 joined(*)"}, "'joined(*)': expected a plain value, not a pattern"},
    {{"up 120 joined(11:5 *)"}, "'joined(11:5 *)': expected a plain value, not a pattern"},
    {{"up 120 joined(11:$x success)"},
     "'joined(11:$x success)': expected a plain value, not a pattern"},
    {{"up 120 joined(result=success ...)"},
     "'joined(result=success ...)': expected a plain value, not a pattern"},
    {{"up 120 op_result(result=1 result=0)"},
     "'op_result(result=1 result=0)': a field is given twice"},
    {{"up 120 start_all()"}, "'start_all()' is not an event or result for an application"},
    {{"up 120 op_result(success)", "up 119 op_result(success)"},
     "its time is 119, and 120 has passed"},
    {{"up 120 op_result(success)", "up 121 op_result(success)"},
     "its time is 121, but `until` ends at the first instant at which something is written, 120"},
    {{"up 120 op_result(success)", "done 300"}, "done at 300, expected 120"},
};

TEST(RctAnswer, EveryWayToBeWrong) {
  for (const Bad& bad : kBad) {
    EXPECT_EQ(wrong_with(until(), bad.lines), "line " + std::to_string(bad.lines.size()) +
                                                  " of the answer to `until 300`: " + bad.wrong);
  }
}

TEST(RctAnswer, LongLinesAreShownInPart) {
  const std::string wrong = wrong_with(until(), {std::string(5000, 'x')});
  EXPECT_LT(wrong.size(), 250U);
}

TEST(RctAnswer, NothingButTheClosingLineBeforeANodeRuns) {
  Asked asked{.command = "reset mote id=5", .closing = "ready"};
  EXPECT_EQ(wrong_with(asked, {"tx 0 radio 00"}),
            "line 1 of the answer to `reset mote id=5`: expected `ready`, given 'tx 0 radio 00'");
  EXPECT_EQ(wrong_with(asked, {"note new", "ready"}), "");
}

std::string hello_wrong_with(const std::string& line) {
  try {
    read_hello(line);
  } catch (const runner::TargetBroken& error) {
    return std::string(error.what()).substr(std::string(error.what()).rfind("': ") + 3);
  }
  return "";
}

TEST(RctAnswer, Hello) {
  const Identity who =
      read_hello("hello rct/1 a 2 response=350 roles=mote,sink time=real join_period=1024");
  EXPECT_EQ(who.name, "a");
  EXPECT_EQ(who.version, "2");
  EXPECT_EQ(who.roles, (std::vector{machine::Role::kMote, machine::Role::kSink}));
  EXPECT_TRUE(who.real_time);
  EXPECT_EQ(trace::statement_text(who.stated), "response=350 join_period=1024");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote roles=sink"), "it says roles= twice");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote time=real time=real"),
            "it says time= twice");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote,sink,mote"),
            "it says the role mote twice");
  EXPECT_NE(hello_wrong_with("hello rct/1 a 2 roles=mote time=warped"), "");
  const std::string known =
      "roles, time, links, response, join_period, join_requests, ack_joins, ack_timeout, "
      "channel_access, members, channels, synaptic_period, synaptic_phase, gone_after, buffers";
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote fast"),
            "'fast' is not key=value, such as roles=mote; known are " + known);
  EXPECT_NE(hello_wrong_with("hello rct/1 a 2 roles=mote =fast"), "");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 response=1"), "it says no roles=");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote ack_timout=2000"),
            "'ack_timout' is nothing that `hello` says; known are " + known);
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote rolls=sink"),
            "'rolls' is nothing that `hello` says; known are " + known);
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote channels=9"),
            "expected channels from 1 to 8 channels, given '9'");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote response=9 response=9"),
            "response is stated twice");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote response=600 ack_timeout=3000"),
            "response=600 leaves no time for a reply within join_period=500: expected a "
            "join_period of at least 620");
  EXPECT_EQ(hello_wrong_with("hello rct/1 a 2 roles=mote response=481 ack_timeout=3000"),
            "response=481 leaves no time for a reply within join_period=500: expected a "
            "join_period of at least 501");
}

TEST(RctAnswer, RealTimeGoesOn) {
  Asked asked = until();
  asked.real_time = true;
  EXPECT_EQ(wrong_with(asked, {"up 120 op_result(1)", "up 310 op_result(1)", "done 311"}), "");
  EXPECT_EQ(wrong_with(asked, {"up 120 op_result(1)", "done 119"}),
            "line 2 of the answer to `until 300`: done at 119, when 120 has passed");
  EXPECT_EQ(wrong_with(asked, {"up 120 op_result(1)", "done 120"}), "");
  EXPECT_EQ(wrong_with(asked, {"done 299"}),
            "line 1 of the answer to `until 300`: done at 299, when nothing was written and 300 "
            "has not come");
}

}  // namespace
}  // namespace rubric::targets
