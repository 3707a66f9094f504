// Interfaces that are switched, acks and joins of the wrong sender: logs with the calls.
#include <gtest/gtest.h>

#include <string>

#include "conformance/check/tests/testing.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check {
namespace {

std::string all(const std::string& log) { return found(kJoined + log, Severity::kWeak); }
std::string end(int ms) { return m2(ms, "< rA am=9->0xffff am(9 x01)"); }

const std::string kOff = m2(100, "< app interface(radio off)");
const std::string kOn = m2(500, "< app interface(radio on)");
const std::string kToPc = "> rA am=2->1 am(28 x000bfffd000b0002000077040305beef)";
std::string send(int ms) {
  return m2(ms, "< app send(dest=11:null app_id=5 reliable=0 data=xbeef)") +
         m2(ms, "> app send_result(seq_num=119)");
}

TEST(InterfaceWatch, OffIsSilent) {
  EXPECT_EQ(all(kOff + m2(110, kToPc)), "") << "It was on its way.";
  EXPECT_EQ(all(kOff + m2(200, kToPc)), "N10-OFF");
  EXPECT_EQ(all(kOff + m2(200, "< power reboot") + m2(210, "> rA am=2->1 am(9 x01)")), "");
}

TEST(InterfaceWatch, OffIsDeaf) {
  const std::string given = m2(300, "< rA am=1->2 am(28 x000b0002000b0001000077040305beef)");
  const std::string taken = m2(300, "> app received(src=11:1 app_id=5 data=xbeef)");
  EXPECT_EQ(all(given + taken), "");
  EXPECT_EQ(all(kOff + given), "");
  EXPECT_EQ(all(kOff + given + taken), "N10-OFF");
}

TEST(InterfaceWatch, OnSendsAgain) {
  EXPECT_EQ(all(kOff + kOn + send(600) + m2(605, kToPc) + end(1000)), "");
  const std::string call = m2(600, "< app send(dest=11:null app_id=5 reliable=0 data=xbeef)");
  const std::string result = m2(600, "> app send_result(seq_num=119)");
  EXPECT_EQ(all(kOff + kOn + call + m2(600, kToPc) + result + end(1000)), "");
  EXPECT_EQ(all(kOff + kOn + send(600) + end(1000)), "N10-ON");
  EXPECT_EQ(all(kOff + kOn + send(600) + end(700)), "");
}

TEST(InterfaceWatch, ItsStateIsReported) {
  const std::string asked = m2(300, "< app get_interface(radio)");
  const std::string on = m2(300, "> app interface_state(radio on)");
  const std::string off = m2(300, "> app interface_state(radio off)");
  EXPECT_EQ(all(asked + on), "");
  EXPECT_EQ(all(asked + off), "N10-STATE");
  EXPECT_EQ(all(kOff + asked + off), "");
  EXPECT_EQ(all(kOff + asked + on), "N10-STATE");
}

// Mote 2 sends a reliable message to mote 7; the ack has these addresses and APPID.
std::string acked(const std::string& ack) {
  return m2(600, "< app send(dest=11:7 app_id=5 reliable=1 data=xbeef)") +
         m2(600, "> app send_result(seq_num=119)") +
         m2(601, "> rA am=2->7 am(28 x000b0007000b0002010077040305beef)") +
         m2(620, "< rA am=7->2 am(28 " + ack + ")") +
         m2(620, "> app ack_received(app_id=5 seq_num=119 result=success)");
}

TEST(AckSender, CountsFromTheDestinationWithItsAppid) {
  EXPECT_EQ(all(acked("x000b0002000b000700001106090517007700")), "");
  EXPECT_EQ(all(acked("x000b0002000b000400001106090517007700")), "T3-SENDER");
  EXPECT_EQ(all(acked("x000b0002000b000700001106090617007700")), "T3-SENDER");
}

TEST(InterfaceWatch, OffHearsNoAck) {
  const std::string ack = m2(900, "< rA am=7->2 am(28 x000b0002000b000700001106090517007700)");
  const std::string sent = m2(500, "< app send(dest=11:7 app_id=5 reliable=1 data=xbeef)") +
                           m2(500, "> app send_result(seq_num=119)") +
                           m2(501, "> rA am=2->7 am(28 x000b0007000b0002010077040305beef)");
  const std::string off = m2(600, "< app interface(radio off)");
  const std::string failed = m2(1500, "> app ack_received(app_id=5 seq_num=119 result=fail)");
  EXPECT_EQ(all(sent + off + ack + failed), "");
  EXPECT_EQ(all(sent + ack + failed), "T3-SUCCESS");
}

// Mote 3 asks and is answered; its ack_join is this.
std::string admitted(const std::string& addresses) {
  const std::string request =
      " rA am=3->1 join_request(seq_num=6 mote_type=1 transducers=1 actuators=1)";
  const std::string reply =
      " rA am=1->3 join_reply(island_addr=11 mote_addr=3 cur_time=605 seq_num=6)";
  return at(600, "m3 < app join(type=1 transducers=1 actuators=1)") + at(601, "m3 >" + request) +
         at(602, "sA <" + request) + at(605, "sA >" + reply) + at(607, "m3 <" + reply) +
         at(609, "sA < rA " + addresses + " seq_num=6 mote_type=1 transducers=1 actuators=1)") +
         at(610, "sA > app mote_joined(11:3 type=1 transducers=1 actuators=1)");
}

TEST(AckJoinSender, IsTheMoteThatAsked) {
  EXPECT_EQ(all(admitted("am=3->1 ack_join(dest=11:1 src=11:3")), "");
  // J4-CONTENT is the mote's finding.
  EXPECT_EQ(all(admitted("am=3->1 ack_join(dest=11:4 src=11:3")), "J4-CONTENT J6-SENDER");
  EXPECT_EQ(all(admitted("am=4->1 ack_join(dest=11:1 src=11:3")), "J6-SENDER");
  EXPECT_EQ(all(admitted("am=3->1 ack_join(dest=11:1 src=12:3")), "J4-CONTENT J6-SENDER");
}

// A message from the sink to m2 with this TRANSID and APPID, and its delivery.
std::string delivered(const std::string& ids) {
  const std::string frame = "rA am=1->2 am(28 x000b0002000b000100007704" + ids + "beef)";
  return at(100, "sA > " + frame) + m2(102, "< " + frame) +
         m2(103, "> app received(src=11:1 app_id=" +
                     std::to_string(std::stoi(ids.substr(2), nullptr, 16)) + " data=xbeef)");
}

TEST(InterfaceWatch, NoApplicationGetsWhatNobodyKnows) {
  EXPECT_EQ(all(delivered("0305")), "");
  EXPECT_EQ(all(delivered("0005")), "T1-UNKNOWN");
  EXPECT_EQ(all(delivered("0300")), "T1-UNKNOWN");
  EXPECT_EQ(all(delivered("0c05")), "T1-UNKNOWN");
  EXPECT_EQ(all(delivered("030c")), "T1-UNKNOWN");
}

TEST(InterfaceWatch, ARequestHasTheDescriptorOfItsCall) {
  const std::string failed = at(100, "m3 < app join(type=1 transducers=1 actuators=1)") +
                             at(101, "m3 > app joined(0:0 fail)");
  const std::string again = at(200, "m3 < app join(type=1 transducers=2 actuators=1)");
  const auto asked = [](int transducers) {
    return at(201, "m3 > rA am=3->1 join_request(seq_num=9 mote_type=1 transducers=" +
                       std::to_string(transducers) + " actuators=1)");
  };
  EXPECT_EQ(all(failed + again + asked(2)), "");
  EXPECT_EQ(all(failed + again + asked(1)), "J1-REQUEST");
  // It may have waited for the line since the call before.
  const std::string busy = at(90, "m3 < rA busy");
  EXPECT_EQ(all(busy + failed + again + at(201, "m3 < rA idle") + asked(1)), "");
}

}  // namespace
}  // namespace rubric::check
