// Messages within messages must be what the application's calls asked for: logs with the calls.
#include <gtest/gtest.h>

#include <string>

#include "conformance/check/tests/testing_log.h"

namespace rubric::check::wrap_test {
namespace {

constexpr const char* kBegin = R"(%rtr 1  %profile paper  %tick ms
%node sA sink id=1 island=11

case log
)";

std::string sink(int ms, const std::string& rest) { return at(ms, "sA " + rest); }
std::string all(const std::string& log) { return found(kBegin + log, Severity::kWeak); }

const std::string kCall = sink(100, "< app send(dest=11:5 app_id=5 reliable=0 data=xbeef)");
const std::string kResult = sink(100, "> app send_result(seq_num=119)");
// TRANSID, APPID and data of the message that leaves.
std::string left(const std::string& content, const std::string& seq_num = "0077") {
  return sink(110, "> rA am=1->5 am(28 x000b0005000b000100" + seq_num + "04" + content + ")");
}

TEST(Wrap, AMessageIsWhatItsCallSays) {
  EXPECT_EQ(all(kCall + kResult + left("0305beef")), "");
  EXPECT_EQ(all(kCall + kResult + left("0306beef")), "T1-WRAP") << "The APPID of another.";
  EXPECT_EQ(all(kCall + kResult + left("0305beee")), "T1-WRAP") << "Other data.";
  EXPECT_EQ(all(kCall + kResult + left("0005beef")), "T1-WRAP") << "No TRANSID.";
}

TEST(Wrap, TheCallBeforeMayStillWait) {
  const std::string other = sink(105, "< app send(dest=11:5 app_id=5 reliable=0 data=xaaaa)") +
                            sink(105, "> app send_result(seq_num=120)");
  EXPECT_EQ(all(kCall + kResult + other + left("0305beef")), "");
  EXPECT_EQ(all(kCall + kResult + other + left("0305aaaa", "0078")), "");
}

TEST(Wrap, SendReturnsTheNumberOfTheMessage) {
  const std::string other = sink(100, "> app send_result(seq_num=118)");
  EXPECT_EQ(all(kCall + other + left("0305beef")), "N1-SEQ");
  const std::string at_once = sink(100, "> rA am=1->5 am(28 x000b0005000b0001000077040305beef)");
  EXPECT_EQ(all(kCall + at_once + kResult), "");
  EXPECT_EQ(all(kCall + at_once + other), "N1-SEQ");
}

TEST(Wrap, ACallThatWasRefusedIsNotTheMessages) {
  const std::string refused = sink(105, "< app send(dest=11:5 app_id=5 reliable=0 data=xbeef)") +
                              sink(105, "> app send_result(seq_num=65535)");
  EXPECT_EQ(all(kCall + kResult + refused + left("0305beef")), "");
}

TEST(Wrap, ARebootForgetsTheCalls) {
  EXPECT_EQ(all(kCall + kResult + sink(105, "< power reboot") + left("0306beef")), "");
}

}  // namespace
}  // namespace rubric::check::wrap_test
