// Logs with more than anybody remembers: what waits is not forgotten, and what comes late is
// judged.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check {
namespace {

// Lines of a base station, by time.
class Log {
 public:
  Log& line(int ms, const std::string& rest) {
    lines_.emplace(ms, at(ms, "bA " + rest));
    return *this;
  }
  // A message up its line: from mote 2.
  Log& comes(int ms, int number, int reliable) {
    return line(ms, "< serA am=0->all " + message("11:null", "11:2", number, reliable));
  }
  Log& delivers(int ms, int number) {
    return line(ms, "> app received(src=11:2 app_id=mockup data=" + data(number) + ")");
  }
  Log& acks(int ms, int number) {
    return line(ms, "> serA am=0->1 " + ack("11:2", "11:null", number));
  }
  Log& calls(int ms, int number, int returned, int reliable) {
    line(ms, fmt::format("< app send(dest=11:2 app_id=mockup reliable={} data={})", reliable,
                         data(number)));
    return line(ms, fmt::format("> app send_result(seq_num={})", returned));
  }
  // A message down its line: to mote 2.
  Log& sends(int ms, int number, int reliable) {
    return line(ms, "> serA am=0->1 " + message("11:2", "11:null", number, reliable));
  }
  Log& is_acked(int ms, int number) {
    line(ms, "< serA am=0->all " + ack("11:null", "11:2", number));
    return line(ms,
                fmt::format("> app ack_received(app_id=mockup seq_num={} result=success)", number));
  }

  std::string broken() const {
    std::string log =
        "%rtr 1\n%profile paper\n%tick ms\n%node bA base_station island=11 iut whole\n"
        "%node sA sink id=1 island=11\ncase run\n" +
        at(0, "bA > serA am=0->1 config(type=set_island_id value=11)");
    for (const auto& [ms, text] : lines_) log += text;
    const int end = lines_.rbegin()->first + 9000;
    return broken_in(judge_log(log + fmt::format("   @0..{} bA !> * *\n", end)));
  }

 private:
  static std::string data(int number) { return fmt::format("x{:04x}", number); }
  static std::string message(const char* dest, const char* src, int number, int reliable) {
    return fmt::format(
        "net_msg(dest={} src={} reliable={} seq_num={} nbytes=4 payload.trans_id=connless "
        "payload.app_id=mockup payload.payload={})",
        dest, src, reliable, number, data(number));
  }
  static std::string ack(const char* dest, const char* src, int number) {
    return fmt::format(
        "net_msg(dest={} src={} reliable=0 seq_num=7 nbytes=6 payload.trans_id=rubicon_ack "
        "payload.app_id=mockup payload.body.type=learning_notification payload.body.seq_num={} "
        "payload.body.ack=0)",
        dest, src, number);
  }

  std::multimap<int, std::string> lines_;
};

constexpr int kMany = 300;

TEST(LongLog, MessagesThatWaitForTheApplicationAndTheirAcks) {
  for (const int reliable : {0, 1}) {
    Log log;
    for (int i = 0; i < kMany; ++i) {
      log.comes(10 + i, i, reliable).delivers(210 + i, i);
      if (reliable == 1) log.acks(210 + i, i);
    }
    EXPECT_EQ(log.broken(), "") << reliable;
  }
}

TEST(LongLog, MessagesThatWaitForTheirAcks) {
  Log log;
  for (int i = 0; i < kMany; ++i) {
    log.calls(10 + i, i, i, 1).sends(20 + i, i, 1).is_acked(520 + i, i);
  }
  EXPECT_EQ(log.broken(), "");
}

TEST(LongLog, AMistakeAfterManyCalls) {
  const auto honest = [] {
    Log log;
    for (int i = 0; i < kMany; ++i) log.calls(10 + 20 * i, i, i, 0).sends(20 + 20 * i, i, 0);
    return log;
  };
  constexpr int kThen = 10 + 20 * kMany;
  EXPECT_EQ(honest().broken(), "");
  EXPECT_EQ(honest().sends(kThen, kMany, 0).broken(), "T1-WRAP");
  EXPECT_EQ(honest().sends(kThen, kMany - 1, 0).broken(), "N2-ONCE");
  EXPECT_EQ(honest().calls(kThen, kMany, kMany, 0).broken(), "N8-SERIAL");
  EXPECT_EQ(honest().calls(kThen, kMany, kMany + 1, 0).sends(kThen, kMany, 0).broken(), "N1-SEQ");
}

}  // namespace
}  // namespace rubric::check
