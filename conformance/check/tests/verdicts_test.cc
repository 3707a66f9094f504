// Whole logs made by hand: violators that once passed, and conformers that once failed.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check {
namespace {

TEST(Verdicts, OfWholeLogs) {
  std::ifstream file("conformance/check/tests/testdata/whole_logs.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::size_t logs = 0;
  for (std::size_t at = text.find("\n== "); at != text.npos; ++logs) {
    const std::size_t colon = text.find(':', at);
    const std::size_t begin = text.find('\n', colon) + 1;
    const std::string rules = text.substr(at + 4, colon - at - 4);
    const std::string what = text.substr(colon + 2, begin - colon - 3);
    at = text.find("\n== ", begin);
    const std::size_t end = at == text.npos ? text.size() : at + 1;
    EXPECT_EQ(broken_in(judge_log(text.substr(begin, end - begin))),
              rules == "nothing" ? "" : rules)
        << what;
  }
  EXPECT_GT(logs, 25U);
}

// A base station's log has one end of its sink's line, and nothing of the air.
TEST(Verdicts, ASinkOfWhichOnlyTheLineIsLoggedForwardsWhatNobodySaw) {
  for (const char* whole : {"", " whole"}) {
    const std::string log = std::string("%rtr 1\n%node bA base_station island=11") + whole +
                            "\ncase x\n" +
                            at(7000,
                               "bA < serA am=0->all net_msg(dest=11:null src=11:5 reliable=0 "
                               "seq_num=3 payload.trans_id=connless payload.app_id=mockup "
                               "payload.payload=x01)") +
                            at(7000, "bA > app received(11:5 mockup x01)");
    EXPECT_EQ(broken_in(judge_log(log, true)), "") << whole;
  }
}

// By a log that is not whole a reply may come late (decision 125), not never, nor after that of a
// later request.
TEST(Verdicts, ALateReply) {
  const std::string nodes =
      "%rtr 1\n%node sA sink id=1 island=11 iut\n%node m5 mote id=5\n%node m6 mote id=6\n"
      "%node bA base_station island=11\ncase x\n";
  const auto request = [](int tick, const std::string& mote, const std::string& number) {
    return at(tick, "sA < rA am=" + mote + "->1 join_request(seq_num=" + number +
                        " mote_type=telosb_demo transducers=light actuators=led)");
  };
  const auto reply = [](int tick, const std::string& mote, const std::string& number) {
    return at(tick, "sA > rA am=1->" + mote + " join_reply(island_addr=11 mote_addr=" + mote +
                        " cur_time=" + std::to_string(tick) + " seq_num=" + number + ")");
  };
  const auto passes = [](int tick, const std::string& number) {
    const std::string net = "net_msg(dest=11:7 src=11:null reliable=0 seq_num=" + number +
                            " payload.trans_id=connless payload.app_id=mockup "
                            "payload.payload=x01)";
    return at(tick, "sA < serA am=0->1 " + net) + at(tick + 1, "sA > rA am=1->7 " + net);
  };
  const std::string asked = nodes + request(0, "5", "300");
  EXPECT_EQ(broken_in(judge_log(asked + passes(310, "60") + reply(320, "5", "300"))), "");
  EXPECT_EQ(broken_in(judge_log(asked + passes(310, "60") + passes(4000, "61"))), "J3-REPLY");
  const std::string both = asked + request(5, "6", "400");
  EXPECT_EQ(broken_in(judge_log(both + reply(330, "6", "400") + passes(340, "60"))),
            "J9-INTERLEAVE");
}

// More wait for a busy radio than are remembered one by one; what was never given is found after.
TEST(Verdicts, AFloodThatWaitsIsNotForgotten) {
  const auto net = [](int number, const char* data) {
    return "net_msg(dest=11:7 src=11:null reliable=0 seq_num=" + std::to_string(number) +
           " payload.trans_id=connless payload.app_id=mockup payload.payload=" + data + ")";
  };
  std::string log =
      "%rtr 1\n%node sA sink id=1 island=11 iut whole\n%node bA base_station island=11\ncase x\n" +
      at(0, "sA < rA busy");
  std::string sent = at(2000, "sA < rA idle");
  for (int i = 0; i < 400; ++i) {
    log += at(1000 + i, "sA < serA am=0->1 " + net(i, "x01"));
    sent += at(2000 + 5 * i, "sA > rA am=1->7 " + net(i, "x01"));
  }
  log += sent;
  EXPECT_EQ(broken_in(judge_log(log, true)), "");
  EXPECT_EQ(broken_in(judge_log(log + at(6000, "sA > rA am=1->7 " + net(399, "x02")), true)),
            "N7-CONTENT");
}

// What of a log of the application alone sends and receives is seen nowhere.
TEST(Verdicts, AnApplicationAloneIsNotBlamed) {
  const std::string log =
      "%node m5 mote id=5\ncase x\n" + at(0, "m5 < app join(telosb_demo light led)") +
      at(10, "m5 > app joined(11:5 success)") +
      at(1000, "m5 < app send(dest=11:1 app_id=mockup reliable=1 data=x01)") +
      at(1000, "m5 > app send_result(20)") + at(1010, "m5 > app ack_received(mockup 20 success)") +
      at(2000, "m5 < app send(dest=11:1 app_id=mockup reliable=0 data=x01)") +
      at(2000, "m5 > app send_result(21)") + at(9000, "m5 > app received(11:1 mockup x07)");
  // Nor is it if the log has the radio of another node.
  const std::string other =
      at(9500, "m6 > rA am=6->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)");
  for (const bool complete : {false, true}) {
    for (const std::string& its : {std::string(), other}) {
      const Report report = judge_log("%rtr 1\n%node m6 mote id=6\n" + log + its, complete);
      EXPECT_EQ(broken_in(report), "") << its;
      EXPECT_EQ(report.verdict, Verdict::kInconclusive);
    }
  }
}

}  // namespace
}  // namespace rubric::check
