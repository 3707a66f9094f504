// Synaptic channels in logs that have the calls.
#include <gtest/gtest.h>

#include <string>

#include "conformance/check/tests/testing_log.h"

namespace rubric::check::synaptic_watch_test {
namespace {

constexpr const char* kBegin = R"(%rtr 1  %profile paper  %tick ms
%node m2 mote id=2
%node sA sink id=1 island=11

case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @1 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @5 sA > rA am=1->2 join_reply(island_addr=11 mote_addr=2 cur_time=5 seq_num=5)
   @9 m2 > rA am=2->1 ack_join(dest=11:1 src=11:2 seq_num=5 mote_type=1 transducers=1 actuators=1)
)";

// `seq_digit` is the last digit of the message's number.
std::string data(int ms, int seq_digit, const std::string& bytes) {
  return m2(ms, "> rA am=2->1 am(28 x000b0001000b000200000" + std::to_string(seq_digit) + "06010b" +
                    bytes + ")");
}

std::string fails(const std::string& log) { return found(kBegin + log, Severity::kFail); }

std::string channel(const std::string& mode) {
  return m2(100, "< app create_out(dest=11:1 size=1 mode=" + mode + ")") +
         m2(110, "< app write_output(channel=2->1 pos=0 value=1)") +
         m2(120, "< app start(channel=2->1)");
}

TEST(SynapticWatch, SteadyDataPasses) {
  EXPECT_EQ(fails(channel("reliable") + data(600, 1, "0000803f") + data(1090, 2, "0000803f") +
                  data(1580, 3, "0000803f")),
            "");
}

TEST(SynapticWatch, TheClockMayBeSetBeforeThereIsAChannel) {
  const std::string data_250 = channel("reliable") + data(400, 1, "0000803f") +
                               data(650, 2, "0000803f") + data(900, 3, "0000803f");
  EXPECT_EQ(fails(m2(90, "< app set_time_step(clock=250)") + data_250), "");
  EXPECT_NE(fails(data_250), "");
}

TEST(SynapticWatch, TicksTooCloseFail) {
  EXPECT_EQ(fails(channel("reliable") + data(600, 1, "0000803f") + data(900, 2, "0000803f")),
            "S2-TICK");
}

// The data of a tick leave one after the other; the next tick may have only the last of them.
TEST(SynapticWatch, OneTickSendsForAllChannels) {
  const auto data_to = [](int ms, const char* devid, int seq_num, const char* bytes) {
    const std::string number = std::to_string(seq_num);
    return m2(ms, std::string("> rA am=2->") + devid + " am(28 x000b000" + devid + "000b000200000" +
                      number + "06010b" + bytes + ")");
  };
  const std::string tick = data_to(600, "1", 1, "0000803f") + data_to(625, "3", 2, "0000803f") +
                           data_to(650, "4", 3, "0000803f");
  const std::string write = m2(700, "< app write_output(channel=2->4 pos=0 value=2)");
  const std::string calls = m2(100, "< app create_out(dest=11:1 size=1 mode=power_save)") +
                            m2(100, "< app create_out(dest=11:3 size=1 mode=power_save)") +
                            m2(100, "< app create_out(dest=11:4 size=1 mode=power_save)") +
                            m2(120, "< app start_all()");
  EXPECT_EQ(fails(calls + tick + write + data_to(1090, "4", 4, "00000040")), "");
  EXPECT_EQ(fails(calls + tick + write + data_to(1000, "4", 4, "00000040")), "S2-TICK");
}

TEST(SynapticWatch, AnotherPeriodIsKept) {
  EXPECT_EQ(fails(channel("reliable") + m2(130, "< app set_time_step(clock=200)") +
                  data(600, 1, "0000803f") + data(800, 2, "0000803f")),
            "");
}

TEST(SynapticWatch, PowerSaveIsSilentWithoutAChange) {
  const std::string first = channel("power_save") + data(600, 1, "0000803f");
  EXPECT_EQ(fails(first + data(2090, 2, "0000803f")), "S3-UNCHANGED");
  EXPECT_EQ(fails(first + m2(2000, "< app write_output(channel=2->1 pos=0 value=2)") +
                  data(2090, 2, "00000040")),
            "");
}

TEST(SynapticWatch, StoppedAndDisposedChannelsAreSilent) {
  const std::string first = channel("reliable") + data(600, 1, "0000803f");
  EXPECT_EQ(fails(first + m2(700, "< app stop(channel=2->1)") + data(1580, 2, "0000803f")),
            "S6-STOPPED");
  EXPECT_EQ(fails(first + m2(700, "< app dispose(channel=2->1)") + data(1580, 2, "0000803f")),
            "S6-DISPOSED");
}

TEST(SynapticWatch, OneValueForEachConnection) {
  EXPECT_EQ(fails(channel("reliable") +
                  m2(600, "> rA am=2->1 am(28 x000b0001000b00020000010a010b0000803f0000803f)")),
            "S2-CONTENT");
}

}  // namespace
}  // namespace rubric::check::synaptic_watch_test
