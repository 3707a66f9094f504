// Duties of the ticks of a synaptic clock, in logs that have the calls and what was given.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>

#include "conformance/check/tests/testing.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check::synaptic_ticks_test {
namespace {

std::string sink(int ms, const std::string& rest) { return at(ms, "sA " + rest); }
std::string digit(int n) { return std::to_string(n); }
// Returns data of m2 to the sink, or to mote 3.
std::string data(int ms, int seq) {
  return m2(ms, "> rA am=2->1 am(28 x000b0001000b000200000" + digit(seq) + "06010b0000803f)");
}
std::string data_to_3(int ms, int seq) {
  return m2(ms, "> rA am=2->3 am(28 x000b0003000b000200000" + digit(seq) + "06010b0000803f)");
}
std::string to_sink(int ms, int seq) {
  return data(ms, seq) +
         sink(ms + 3, "< rA am=2->1 am(28 x000b0001000b000200000" + digit(seq) + "06010b0000803f)");
}
std::string out(const std::string& mode) {
  return m2(100, "< app create_out(dest=11:1 size=1 mode=" + mode + ")") +
         m2(110, "< app start(channel=2->1)");
}
std::string end(int ms) { return m2(ms, "< rA am=9->0xffff am(9 x01)"); }

std::string sorted(const std::string& log) {
  std::multimap<int, std::string> lines;
  std::istringstream in(log);
  for (std::string line; std::getline(in, line);) {
    lines.emplace(std::stoi(line.substr(line.find('@') + 1)), line + "\n");
  }
  std::string out;
  for (const auto& [ms, line] : lines) out += line;
  return out;
}
// Lines in any order.
std::string all(const std::string& log) { return found(kJoined + sorted(log), Severity::kWeak); }

TEST(SynapticTicks, EachTickSends) {
  const std::string three = out("reliable") + data(640, 1) + data(1130, 2) + data(1620, 3);
  EXPECT_EQ(all(three + end(2000)), "");
  EXPECT_EQ(all(three + end(2700)), "S2-SEND");
  EXPECT_EQ(all(out("reliable") + end(1500)), "S2-SEND");
  EXPECT_EQ(all(out("reliable") + data(640, 1) + data(1620, 2) + end(1700)), "S2-SEND");
}

TEST(SynapticTicks, DataAreWhatWasWritten) {
  const auto wrote = [](const std::string& pos) {
    return m2(120, "< app write_output(channel=2->1 pos=" + pos + " value=1)");
  };
  EXPECT_EQ(all(out("reliable") + wrote("0") + data(640, 1)), "");
  const std::string two = "> rA am=2->1 am(28 x000b0001000b00020000010a010b";
  const std::string both = m2(100, "< app create_out(dest=11:1 size=2 mode=reliable)") +
                           m2(110, "< app start(channel=2->1)");
  EXPECT_EQ(all(both + wrote("1") + m2(640, two + "000080400000803f)")), "")
      << "The other is free.";
  EXPECT_EQ(all(both + wrote("1") + m2(640, two + "0000803f00000000)")), "S2-CONTENT");
  EXPECT_EQ(all(both + wrote("1") + m2(130, two + "0000803f00000000)")), "") << "Before its tick.";
}

TEST(SynapticTicks, WhatCannotSendDoesNot) {
  const std::string three = out("reliable") + data(640, 1) + data(1130, 2);
  EXPECT_EQ(all(three + m2(1200, "< app stop(channel=2->1)") + end(2700)), "");
  EXPECT_EQ(all(three + m2(1200, "< app interface(radio off)") + end(2700)), "");
  EXPECT_EQ(all(three + m2(1200, "< power off") + end(2700)), "");
  EXPECT_EQ(all(three + m2(1200, "< app set_time_step(clock=3000)") + end(2700)), "");
}

TEST(SynapticTicks, AChangeIsSent) {
  const std::string first = out("power_save") + data(640, 1);
  EXPECT_EQ(all(first + end(4000)), "");
  const std::string written = first + m2(2000, "< app write_output(channel=2->1 pos=0 value=2)");
  EXPECT_EQ(all(written + end(4000)), "S3-CHANGED");
  const std::string two = "> rA am=2->1 am(28 x000b0001000b00020000020601";
  EXPECT_EQ(all(written + m2(2100, two + "0b00000040)") + end(4000)), "");
  EXPECT_EQ(all(written + data(2100, 2) + end(4000)), "S3-CHANGED") << "The old value.";
  EXPECT_EQ(all(out("power_save") + end(1500)), "S3-FIRST");
  EXPECT_EQ(all(out("power_save") + m2(200, "< app write_output(channel=2->1 pos=0 value=2)") +
                end(1500)),
            "S3-CHANGED");
}

std::string in(const std::string& rest) {
  return sink(110, "< app create_in(src=11:2 size=1 mode=reliable)") +
         sink(110, "< app start(channel=2->1)") + rest;
}
std::string told(int ms, const std::string& status) {
  return sink(ms, "> app syn_data(channel=2->1 status=" + status + ")");
}

TEST(SynapticTicks, EachTickSignals) {
  EXPECT_EQ(all(in(told(600, "old") + told(1090, "old") + end(1500))), "");
  EXPECT_EQ(all(in(told(600, "old") + told(1090, "old") + end(2500))), "S2-SIGNAL");
  EXPECT_EQ(all(in(end(1500))), "S2-SIGNAL");
  EXPECT_EQ(all(in(sink(300, "< app stop(channel=2->1)") + end(1500))), "");
  EXPECT_EQ(all(in(sink(300, "< app stop(channel=2->1)") + told(600, "old"))), "S6-STOPPED");
}

TEST(SynapticTicks, AReadTellsWhatCameLast) {
  const auto came = [](int ms, int seq, const std::string& value) {
    const std::string frame =
        "rA am=2->1 net_msg(dest=11:1 src=11:2 reliable=0 seq_num=" + digit(seq) +
        " payload.trans_id=syn_channel payload.app_id=learning payload.body.values=[" + value +
        "])";
    return m2(ms, "> " + frame) + sink(ms + 3, "< " + frame);
  };
  const auto read = [](int ms, const std::string& value) {
    return sink(ms, "< app read_input(channel=2->1 pos=0)") +
           sink(ms + 1, "> app input_value(value=" + value + " result=success)");
  };
  // The sink's log is whole, though results are left out here.
  const auto blamed = [](const std::string& log) {
    const std::string joined = kJoined;
    const std::size_t end = joined.find("island=11") + 9;
    const std::string whole = joined.substr(0, end) + " iut whole" + joined.substr(end);
    return found(whole + sorted(log), Severity::kFail).find("S1-READ") != std::string::npos;
  };
  const std::string two = out("reliable") + in(came(640, 1, "1.5") + told(700, "new") +
                                               came(1140, 2, "2.5") + told(1190, "new"));
  EXPECT_FALSE(blamed(two + read(1000, "1.5") + read(1160, "1.5") + read(1500, "2.5")));
  EXPECT_FALSE(blamed(two + read(1160, "2.5"))) << "It is taken at once.";
  EXPECT_FALSE(blamed(two + read(400, "7"))) << "Before any came it is free.";
  EXPECT_TRUE(blamed(two + read(1100, "7"))) << "It never came.";
  EXPECT_TRUE(blamed(two + read(1500, "1.5"))) << "It was overwritten.";
  const std::string again =
      sink(1200, "< app stop(channel=2->1)") + sink(1210, "< app start(channel=2->1)");
  EXPECT_FALSE(blamed(two + again + read(1500, "0"))) << "A start may forget what came before.";
  const std::string copy = sink(1145,
                                "< rA am=2->1 net_msg(dest=11:1 src=11:2 reliable=0 "
                                "seq_num=1 payload.trans_id=syn_channel "
                                "payload.app_id=learning payload.body.values=[1.5])");
  EXPECT_FALSE(blamed(two + copy + read(1500, "2.5"))) << "An old frame that came again.";
}

TEST(SynapticTicks, TheStatusSaysWhetherDataCame) {
  const std::string sends = out("reliable");
  EXPECT_EQ(all(sends + in(to_sink(640, 1) + told(700, "new") + told(1190, "old"))), "");
  EXPECT_EQ(all(sends + in(told(600, "old") + told(1090, "new") + end(1100))), "S2-SEND S3-OLD");
  EXPECT_EQ(all(sends + in(told(600, "old") + to_sink(700, 1) + told(1090, "old") + end(1100))),
            "S2-SIGNAL");
  // Close to a tick either may be signalled.
  EXPECT_EQ(all(sends + in(told(460, "old") + to_sink(940, 1) + told(950, "old") +
                           told(1440, "new") + end(1450))),
            "");
}

// Mote 2 sends to the sink; a second channel is started later.
TEST(SynapticTicks, AStartShiftsNoOtherChannel) {
  const std::string first = out("reliable") + data(640, 1) + data(1128, 2);
  const std::string second = m2(1300, "< app create_out(dest=11:3 size=1 mode=reliable)") +
                             m2(1310, "< app start(channel=2->3)");
  const auto later = [](int ms) {
    std::string lines;
    for (int tick = 0; tick < 3; ++tick) {
      lines += data(ms + 488 * tick, 3 + 2 * tick) + data_to_3(ms + 2 + 488 * tick, 4 + 2 * tick);
    }
    return lines;
  };
  EXPECT_EQ(all(first + second + later(1616)), "");
  EXPECT_EQ(all(first + second + later(1798)), "S6-CLOCK");
}

// Of two channels of a mote one has data that the link repeats; those of the other wait meanwhile.
TEST(SynapticTicks, DataWaitWhileTheLinkRepeatsOthers) {
  const auto repeated = [](int times) {
    Script script = Script().join(0, 11, 2, 100).join(60, 11, 3, 200);
    const auto data = [&](double ms, std::uint16_t to, std::uint16_t number) {
      NetFields net = message({11, 2}, {11, to}, number);
      net.body.assign(4, 0);
      net.trans_id = component::kSynChannel;
      net.app_id = static_cast<std::uint8_t>(rubicon::Component::kEsnData);
      script.net(ms, 2, to, net);
    };
    for (std::uint16_t tick = 0; tick < 3; ++tick) {
      const double ms = 1000 + 488.3 * tick;
      data(ms, 3, tick);
      for (int i = 1; i <= times && tick == 1; ++i) {
        --script.dsn[2];
        data(ms + 18 * i, 3, tick);
      }
      data(ms + (tick == 1 ? 60 : 4), 1, static_cast<std::uint16_t>(tick + 10));
    }
    return found_beside(script, m2(200, "< app create_out(dest=11:3 size=1 mode=reliable)") +
                                    m2(200, "< app create_out(dest=11:1 size=1 mode=reliable)") +
                                    m2(510, "< app start_all()"));
  };
  EXPECT_EQ(repeated(3).find("S2-TICK"), std::string::npos) << repeated(3);
  EXPECT_NE(repeated(0).find("F:S2-TICK"), std::string::npos) << repeated(0);
}

// The data of the first tick escaped, so that nothing was seen to leave since the last write.
TEST(SynapticTicks, DataThatEscapedWereStillOwed) {
  const auto saves = [](bool escapes) {
    Script script = Script().join(0, 11, 2, 100);
    const auto data = [&](double ms, std::uint16_t number) {
      NetFields net = message({11, 2}, {11, 1}, number);
      net.body = {0, 0, 0x80, 0x3F};
      net.trans_id = component::kSynChannel;
      net.app_id = static_cast<std::uint8_t>(rubicon::Component::kEsnData);
      script.net(ms, 2, 1, net);
    };
    if (escapes) {
      ++script.dsn[2];
    } else {
      data(680, 1);
    }
    data(1168, 2);
    if (escapes) data(1656, 3);
    return found_beside(script, m2(100, "< app create_out(dest=11:1 size=1 mode=power_save)") +
                                    m2(160, "< app write_output(2->1 pos=0 value=1)") +
                                    m2(160, "< app start(channel=2->1)") +
                                    m2(1900, "< app get_interface(radio)"));
  };
  EXPECT_NE(saves(false).find("F:S3-UNCHANGED"), std::string::npos) << saves(false);
  const std::string found = saves(true);  // Only the third is too many.
  EXPECT_EQ(found.find("F:S3-UNCHANGED"), found.rfind("F:S3-UNCHANGED")) << found;
}

}  // namespace
}  // namespace rubric::check::synaptic_ticks_test
