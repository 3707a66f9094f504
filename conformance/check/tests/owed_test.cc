// Deliveries, acks, events and messages of its own that a node owes by its own log and never gives.
// The logs have what the node was given, and its application.
#include <gtest/gtest.h>

#include <string>

#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check {
namespace {

constexpr const char* kMote = R"(%rtr 1  %profile paper  %tick ms
%node m5 mote id=5 iut
%node sA sink id=1 island=11
case log
)";
std::string mote(int ms, const std::string& rest) { return at(ms, "m5 " + rest); }

// A message of island 11, for APPID MOCKUP.
std::string net(const std::string& dest, const std::string& src, bool reliable = false) {
  return "am(28 x000b" + dest + "000b" + src + (reliable ? "01" : "00") + "0064040305beef)";
}

const std::string kAsks =
    mote(0, "< app join(2 light led)") +
    mote(0, "> rA am=5->1 join_request(seq_num=7 mote_type=2 transducers=light actuators=led)") +
    mote(9, "< rA am=1->5 join_reply(island_addr=11 mote_addr=5 cur_time=0 seq_num=7)");
const std::string kAcks = mote(10,
                               "> rA am=5->1 ack_join(dest=11:1 src=11:5 seq_num=7 mote_type=2 "
                               "transducers=light actuators=led)");
const std::string kJoins = kAsks + kAcks + mote(10, "> app joined(11:5 success)");
std::string to_mote(bool reliable = false) {
  return mote(1000, "< rA am=2->5 " + net("0005", "0002", reliable));
}
const std::string kDelivers = mote(1010, "> app received(11:2 mockup xbeef)");

// With a mote's log that goes on for long enough.
std::string of_mote(const std::string& log) {
  const std::string later = mote(2000, "< app get_interface(radio)");
  return found(kMote + log + later, Severity::kWeak);
}

TEST(Owed, ADeliveryToTheApplication) {
  EXPECT_EQ(of_mote(kJoins + to_mote() + kDelivers), "");
  EXPECT_EQ(of_mote(kJoins + to_mote()), "N5-DELIVER");
  // Nobody said that it is a member: not yet, perhaps (decision 118).
  EXPECT_EQ(of_mote(kAsks + kAcks + to_mote() + mote(1500, "> app joined(11:5 success)")), "");
  EXPECT_EQ(found(kMote + kJoins + to_mote(), Severity::kWeak), "") << "The log ends before.";
}

TEST(Owed, ACopyNeedNotBeDeliveredAgain) {
  const std::string again = mote(1400, "< rA am=2->5 " + net("0005", "0002"));
  EXPECT_EQ(of_mote(kJoins + to_mote() + kDelivers + again), "");
}

TEST(Owed, ABusyApplicationGetsItLater) {
  EXPECT_EQ(of_mote(kJoins + mote(900, "< app busy") + to_mote()), "");
}

TEST(Owed, WhatIsSwitchedOffOwesNothing) {
  EXPECT_EQ(of_mote(kJoins + to_mote() + mote(1050, "< app interface(radio off)") +
                    mote(1050, "> app op_result(success)")),
            "");
}

TEST(Owed, AnAckAtTheEndOfALog) {
  EXPECT_EQ(of_mote(kJoins + to_mote(true) + kDelivers), "T2-ACK");
}

// The same in a log that is whole, up to its end.
std::string of_whole(const std::string& log, int until_ms) {
  std::string head = kMote;
  head.replace(head.find(" iut"), 4, " iut whole");
  const std::string end = "   @0.." + std::to_string(until_ms) + " m5 !> * *\n";
  return found(head + log + end, Severity::kInconclusive);
}

TEST(Owed, AWholeLogSaysWhenItEnds) {
  const std::string ack = "am(28 x000b0002000b000500007706090517006400)";
  EXPECT_EQ(of_whole(kJoins + to_mote(), 1200), "");
  EXPECT_EQ(of_whole(kJoins + to_mote(), 1400), "N5-DELIVER");
  const std::string taken = kJoins + to_mote(true) + kDelivers;
  EXPECT_EQ(of_whole(taken, 1400), "T2-ACK");
  EXPECT_EQ(of_whole(taken + mote(1200, "> rA am=5->2 " + ack), 1400), "");
  EXPECT_EQ(of_whole(taken + mote(1400, "> rA am=5->2 " + ack), 1900), "T2-ACK") << "Too late.";
}

TEST(Owed, ALineKeepsTheOrderInWhichItAccepted) {
  const std::string send =
      mote(1000, "< app send(11:2 mockup 0 xbeef)") + mote(1000, "> app send_result(100)");
  const std::string sent = "> rA am=5->2 am(28 x000b0002000b0005000064040305beef)";
  const std::string ack = "> rA am=5->2 am(28 x000b0002000b000500007706090517006400)";
  const std::string hears = mote(1400, "< rA am=2->5 " + net("0005", "0002", true)) +
                            mote(1400, "> app received(11:2 mockup xbeef)");
  const std::string begin =
      kJoins + mote(900, "< rA busy") + send + hears + mote(1800, "< rA idle");
  EXPECT_EQ(of_whole(begin + mote(1800, sent) + mote(1802, ack), 2500), "");
  EXPECT_EQ(of_whole(begin + mote(1800, ack) + mote(1802, sent), 2500), "N2-ORDER");
  EXPECT_EQ(of_whole(kJoins + mote(900, "< rA busy") + send + mote(1010, sent), 1500), "N2-BUSY");
}

TEST(Owed, OutsideNothingIsHeard) {
  const std::string early = mote(1000, "> app received(11:2 mockup xbeef)");
  EXPECT_EQ(of_mote(to_mote() + early), "J11-HEAR");
}

TEST(Owed, TheMessageThatSendAccepted) {
  const std::string call = mote(1000, "< app send(11:2 mockup 0 xbeef)");
  const std::string accepted = mote(1000, "> app send_result(100)");
  const std::string leaves = mote(1010, "> rA am=5->2 " + net("0002", "0005"));
  EXPECT_EQ(of_mote(kJoins + call + accepted + leaves), "");
  EXPECT_EQ(of_mote(kJoins + call + accepted), "N2-ONCE");
  EXPECT_EQ(of_mote(kJoins + call + mote(1000, "> app send_result(65535)")), "");
  EXPECT_EQ(of_mote(kJoins + mote(990, "< rA busy") + call + accepted), "");
  EXPECT_EQ(of_mote(kJoins + call + accepted + mote(1010, "< power reboot")), "");
}

TEST(Owed, TheLocalIslandIsTheOwn) {
  const std::string call = mote(1000, "< app send(local:2 mockup 0 xbeef)");
  const std::string accepted = mote(1000, "> app send_result(100)");
  EXPECT_EQ(of_mote(kJoins + call + accepted + mote(1010, "> rA am=5->2 " + net("0002", "0005"))),
            "");
  const std::string away = "am(28 x000c0002000b0005000064040305beef)";
  EXPECT_EQ(of_mote(kJoins + call + accepted + mote(1010, "> rA am=5->1 " + away)), "N3-LOCAL");
}

TEST(Owed, AMessageThatNobodyAskedFor) {
  const std::string call = mote(1000, "< app send(11:2 mockup 0 xbeef)");
  const std::string refused = mote(1000, "> app send_result(65535)");
  EXPECT_EQ(of_mote(kJoins + call + refused + mote(1010, "> rA am=5->3 " + net("0003", "0005"))),
            "N2-ONCE");
}

TEST(Owed, TheJoinedEvent) {
  EXPECT_EQ(found(kMote + kAsks + kAcks + mote(5000, "< app get_clock()"), Severity::kWeak),
            "J5-SUCCESS");
  EXPECT_EQ(of_mote(kAsks + kAcks), "") << "Its call may still fail.";
  EXPECT_EQ(of_mote(kJoins + mote(1000, "< app join(2 light led)")), "J8-JOINED");
  EXPECT_EQ(of_mote(kJoins + mote(1000, "< app join(2 light led)") +
                    mote(1000, "> app joined(11:5 fail)")),
            "");
}

TEST(Owed, AFirstCallDoesNotFailAtOnce) {
  EXPECT_EQ(of_mote(kAsks + kAcks + mote(10, "> app joined(11:5 fail)")), "J8-FAIL");
}

// A log of one node may name others in its headers as under test; it shows nothing of these.
TEST(Owed, WhatAHeaderAloneNamesSentNothing) {
  const std::string head = R"(%rtr 1  %profile paper  %tick ms
%node sA sink id=1 island=11 iut
%node bA base_station island=11 iut
%link serA serial sA bA
case log
)";
  const std::string came =
      at(100,
         "bA < serA am=0->all net_msg(dest=12:3 src=11:2 reliable=0 seq_num=9 "
         "payload.trans_id=connless payload.app_id=mockup payload.payload=\"hello\")");
  const std::string goes =
      at(110,
         "bA > peis am=11->12 net_msg(dest=12:3 src=11:2 reliable=0 seq_num=9 "
         "payload.trans_id=connless payload.app_id=mockup payload.payload=\"hello\")");
  EXPECT_EQ(found(head + came + goes, Severity::kWeak), "");
  EXPECT_EQ(found(head + goes, Severity::kWeak), "N8-PEIS");
}

TEST(Owed, NoAckOfANodeThatMayBeOutside) {
  const std::string later = mote(3000, "< app get_clock()");
  for (const Finding& finding :
       judge(must_read("log", kMote + to_mote(true) + later), {}).findings) {
    EXPECT_LT(finding.severity, Severity::kFail) << finding.text;
  }
  EXPECT_EQ(of_mote(kJoins + to_mote(true) + kDelivers), "T2-ACK");
}

constexpr const char* kIsland = R"(%rtr 1  %profile paper  %tick ms
%node m5 mote id=5 iut whole
%node sA sink id=1 island=11 iut whole
%node bA base_station island=11 iut whole
%link serA serial sA bA
case log
)";

// Decision 125: lines have no order between them.
TEST(Owed, TheOrderInWhichTwoLinesBringMessagesIsFree) {
  const std::string by_radio = "rA am=5->1 am(28 x000b0001000b0005000064040305beef)";
  const std::string by_serial = "serA am=0->1 am(28 x000b0001000bfffd000065040305cafe)";
  const std::string came = kIsland + at(1000, "m5 > " + by_radio) + at(1001, "bA > " + by_serial) +
                           at(1002, "sA < " + by_serial) + at(1003, "sA < " + by_radio);
  const std::string one = at(1005, "sA > app received(11:null mockup xcafe)");
  const std::string other = at(1005, "sA > app received(11:5 mockup xbeef)");
  EXPECT_EQ(found(came + one + other, Severity::kFail).find("N2-IN-ORDER"), std::string::npos);
  EXPECT_EQ(found(came + other + one, Severity::kFail).find("N2-IN-ORDER"), std::string::npos);
}

TEST(Owed, TheOrderOfMessagesThatAreAlike) {
  const std::string one = "am(28 x000bfffd000b0002000064040305beef)";
  const std::string other = "am(28 x000bfffd000b0003000065040305cafe)";
  const std::string third = "am(28 x000bfffd000b0003000066040305cafe)";
  const auto hears = [](int ms, int src, const std::string& net) {
    return at(ms, "sA < rA am=" + std::to_string(src) + "->1 " + net);
  };
  const auto goes = [](int ms, const std::string& net) {
    return at(ms, "sA > serA am=0->all " + net);
  };
  const std::string came =
      kIsland + hears(1000, 2, one) + hears(1001, 3, other) + hears(1002, 2, one);
  EXPECT_EQ(found(came + goes(1003, one) + goes(1004, other) + goes(1005, one), Severity::kFail)
                .find("N2-ORDER"),
            std::string::npos);
  EXPECT_NE(
      found(came + hears(1003, 3, third) + goes(1004, third) + goes(1005, other), Severity::kFail)
          .find("N2-ORDER"),
      std::string::npos);
}

TEST(Owed, WhatComesAfterTheRadioIsOnAgain) {
  const std::string begin = kIsland + kJoins + at(900, "m5 < app interface(radio off)") +
                            at(900, "m5 > app op_result(success)") +
                            at(1000, "sA > rA am=1->all " + net("ffff", "0001"));
  const std::string on =
      at(1001, "m5 < app interface(radio on)") + at(1001, "m5 > app op_result(success)");
  const std::string comes = at(1004, "m5 < rA am=1->all " + net("ffff", "0001")) +
                            at(1005, "m5 > app received(11:1 mockup xbeef)");
  EXPECT_EQ(found(begin + on + comes, Severity::kFail).find("N10-OFF"), std::string::npos);
  EXPECT_NE(found(begin + comes, Severity::kFail).find("N10-OFF"), std::string::npos);
}

// A message of an application that looks like an announcement is none: the sink forwards what its
// radio heard, or sends what its own application asked for.
TEST(Owed, WhatOnlyLooksLikeAnAnnouncement) {
  const std::string body = "10000c000902000102";  // Of 12:9, which is of another island.
  const auto goes = [&](const std::string& src) {
    return "am(28 x000bfffd000b" + src + "0000640b030a" + body + ")";
  };
  const std::string of_mote = kIsland + at(1000, "m5 > rA am=5->1 " + goes("0005")) +
                              at(1002, "sA < rA am=5->1 " + goes("0005")) +
                              at(1004, "sA > serA am=0->all " + goes("0005"));
  EXPECT_EQ(found(of_mote, Severity::kFail).find("J6-CONTENT"), std::string::npos);
  const std::string sent = at(1004, "sA > serA am=0->all " + goes("0001"));
  const std::string asked = kIsland +
                            at(1000, "sA < app send(11:null control_layer 0 x" + body + ")") +
                            at(1000, "sA > app send_result(100)") + sent;
  EXPECT_EQ(found(asked, Severity::kFail).find("J6-CONTENT"), std::string::npos);
  EXPECT_NE(found(kIsland + sent, Severity::kFail).find("J6-CONTENT"), std::string::npos);
}

// The log of an application beside captures, in which frames are missing.

constexpr machine::Address kPc{11, machine::kNullDevid};

// The PC of island 11 gets a message that its own sink heard from `island`; it may come by PEIS,
// too.
std::string pc_gets(std::uint16_t island, int times) {
  NetFields net = message({island, 3}, kPc, 9, 1);
  Script script;
  script.join(0, 11, 2, 100).join(100, island, 3, 300, island == 11 ? 1 : 2).net(1000, 3, 1, net);
  net.size = 114;
  script.up(1010, net).down(2000, message(kPc, {11, 2}, 20)).confirm();
  script.net(2010, 1, 2, message(kPc, {11, 2}, 20), 11).net(3000, 2, 1, update(2, 7));
  std::string log;
  const std::string gets = "bA > app received(" + std::to_string(island) + ":3 mockup x0707)";
  for (int i = 0; i < times; ++i) log += at(1015 + 40 * i, gets);
  return found_beside(script, log + at(3000, "bA < app get_clock()"), true,
                      "bA base_station island=11");
}

TEST(OwedBesideCaptures, WhatGoesByPeisIsNotSeen) {
  EXPECT_EQ(pc_gets(12, 1).find("F:"), std::string::npos) << pc_gets(12, 1);
  EXPECT_EQ(pc_gets(12, 2).find("F:"), std::string::npos) << pc_gets(12, 2);
  EXPECT_NE(pc_gets(11, 1).find("F:T2-ACK"), std::string::npos) << pc_gets(11, 1);
  EXPECT_NE(pc_gets(11, 2).find("F:N2-IN-ORDER"), std::string::npos) << pc_gets(11, 2);
}

// The capture lacks a message that mote 2 sends at 5000 ms; its log says that it was acked.
std::string acked(bool ack, bool before) {
  Script script;
  if (before) script.join(0, 11, 2, 100);
  script.join(200, 11, 3, 200);
  if (ack) script.net(5050, 1, 2, update(2, 9).ack(30), 11);
  if (before) script.net(5500, 2, 1, update(2, 12));
  script.net(6000, 2, 1, update(2, 13));
  return found_beside(script,
                      m2(10, "< app get_interface(radio)") +
                          m2(5000, "< app send(dest=11:null app_id=mockup reliable=1 data=x0707)") +
                          m2(5000, "> app send_result(9)") +
                          m2(5060, "> app ack_received(mockup 9 success)") +
                          m2(6500, "< app get_interface(radio)"));
}

TEST(OwedBesideCaptures, AMessageThatEscapedMayBeAcked) {
  EXPECT_EQ(acked(true, false).find("F:"), std::string::npos) << acked(true, false);
  EXPECT_EQ(acked(true, true).find("F:"), std::string::npos) << acked(true, true);
  EXPECT_EQ(acked(false, false).find("F:"), std::string::npos) << acked(false, false);
  EXPECT_NE(acked(false, true).find("F:T3-SUCCESS"), std::string::npos) << acked(false, true);
}

// The sink sends message 9 up its line.
std::string sink_acked(bool captured, bool ack) {
  const NetFields net = message({11, 1}, kPc, 9, 1);
  Script script = Script().join(0, 11, 2, 100).net(900, 1, 2, message({11, 1}, {11, 2}, 8), 11);
  if (captured) script.up(5010, net.forwarded());
  if (ack) script.down(5050, net.ack(30)).confirm();
  script.net(6000, 1, 2, message({11, 1}, {11, 2}, 10), 11);
  const std::string call = "sA < app send(dest=11:null app_id=mockup reliable=1 data=x0707)";
  const std::string joined = "sA > app mote_joined(11:2 type=1 transducers=0x43 actuators=1)";
  return found_beside(script,
                      at(30, joined) + at(5000, call) + at(5000, "sA > app send_result(9)") +
                          at(5060, "sA > app ack_received(mockup 9 success)") +
                          at(6500, "sA < app get_interface(radio)"),
                      false, "sA sink id=1 island=11");
}

TEST(OwedBesideCaptures, WhatIsAckedWasSent) {
  EXPECT_EQ(sink_acked(true, true).find(":T3"), std::string::npos) << sink_acked(true, true);
  EXPECT_EQ(sink_acked(false, true).find("F:"), std::string::npos) << sink_acked(false, true);
  EXPECT_NE(sink_acked(false, false).find("F:T3-SUCCESS"), std::string::npos)
      << sink_acked(false, false);
}

// Mote 2 acks three messages; its application gets those for which `gets` has a letter.
std::string gets_of_acked(const std::string& gets) {
  Script script = Script().join(0, 11, 2, 100);
  std::string log = m2(30, "> app joined(11:2 success)");
  for (std::uint16_t i = 0; i < 3; ++i) {
    const double ms = 1000 + 1000 * i;
    const NetFields net = message(kPc, {11, 2}, i, 1);
    script.net(ms, 1, 2, net, 11).net(ms + 20, 2, 1, net.ack(static_cast<std::uint16_t>(30 + i)));
    if (gets[i] != '-') {
      log +=
          m2(static_cast<int>(ms) + 10, std::string("> app received(11:null ") +
                                            (gets[i] == 'm' ? "mockup" : "learning") + " x0707)");
    }
  }
  return found_beside(script, log + m2(6000, "< app get_clock()"));
}

TEST(OwedBesideCaptures, WhatIsAckedIsDelivered) {
  EXPECT_EQ(gets_of_acked("mmm").find(":T"), std::string::npos) << gets_of_acked("mmm");
  EXPECT_NE(gets_of_acked("m-m").find("F:T2-DELIVER"), std::string::npos) << gets_of_acked("m-m");
  // The log of another application.
  EXPECT_EQ(gets_of_acked("---").find("F:"), std::string::npos) << gets_of_acked("---");
}

// The captures end at 3000 ms, and the log goes on; what send accepted then never leaves.
TEST(OwedBesideCaptures, AMessageThatNeverLeaves) {
  const auto unsent = [](int ms) {
    Script script = Script().join(0, 11, 2, 100).net(3000, 2, 1, update(2, 12));
    return found_beside(script,
                        m2(ms, "< app send(dest=11:null app_id=mockup reliable=0 data=x0708)") +
                            m2(ms, "> app send_result(9)") + m2(5000, "< app get_clock()"),
                        true);
  };
  EXPECT_NE(unsent(1000).find("F:N2-ONCE"), std::string::npos) << unsent(1000);
  EXPECT_EQ(unsent(2900).find("F:N2-ONCE"), std::string::npos) << unsent(2900);
}

// Mote 2 gets a second message that says the same, which was not captured.
std::string gets_at(int ms) {
  Script script = Script().join(0, 11, 2, 100).net(1000, 1, 2, message(kPc, {11, 2}, 9, 1), 11);
  if (ms > 1300) ++script.dsn[11 * 65536U + 1];
  script.net(2600, 1, 2, message({11, 1}, {11, 2}, 10), 11);
  script.net(3000, 2, 1, message({11, 2}, {11, 1}, 7));
  return found_beside(script, m2(30, "> app joined(11:2 success)") +
                                  m2(ms, "> app received(11:null mockup x0707)") +
                                  m2(2610, "> app received(11:1 mockup x0707)") +
                                  m2(3000, "< app get_interface(radio)"));
}

TEST(OwedBesideCaptures, ADeliveryMuchLaterMayBeAnother) {
  EXPECT_EQ(gets_at(2500).find("F:"), std::string::npos) << gets_at(2500);
  EXPECT_NE(gets_at(1010).find("F:T2-ACK"), std::string::npos) << gets_at(1010);
}

}  // namespace
}  // namespace rubric::check
