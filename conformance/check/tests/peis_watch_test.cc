// Logs with PEIS: what base stations pass on between it and their sinks.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "conformance/check/tests/testing_log.h"

namespace rubric::check::peis_watch_test {
namespace {

constexpr const char* kBegin = R"(%rtr 1  %profile paper  %tick ms
%node sA sink id=1 island=11
%node bA base_station island=11
%node sB sink id=1 island=12
%node bB base_station island=12
%node m2 mote id=2
case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @1 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @2 sA < rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @5 sA > rA am=1->2 join_reply(island_addr=11 mote_addr=2 cur_time=5 seq_num=5)
   @6 m2 < rA am=1->2 join_reply(island_addr=11 mote_addr=2 cur_time=5 seq_num=5)
   @9 m2 > rA am=2->1 ack_join(dest=11:1 src=11:2 seq_num=5 mote_type=1 transducers=1 actuators=1)
   @9 m2 > app joined(11:2 success)
   @12 sA < rA am=2->1 ack_join(dest=11:1 src=11:2 seq_num=5 mote_type=1 transducers=1 actuators=1)
   @13 sA > app mote_joined(11:2 type=1 transducers=1 actuators=1)
   @14 sA > serA am=0->0xffff am(28 x000bfffd000b00020000000b030a10000b000201000101)
   @20 bA < serA am=0->0xffff am(28 x000bfffd000b00020000000b030a10000b000201000101)
   @20 bA > app received(src=11:2 app_id=10 data=x10000b000201000101)
)";

// From mote 2 of island 11 to the PC of island 12, and to mote 7 there.
const std::string kToPc = "am(28 x000cfffd000b0002000077040305beef)";
const std::string kToMote = "am(28 x000c0007000b0002000077040305beef)";
const std::string kOther = "am(28 x000c0007000b0002000078040305beef)";

std::string up(int ms, const std::string& message) {
  return at(ms, "m2 > rA am=2->1 " + message) + at(ms + 5, "sA < rA am=2->1 " + message) +
         at(ms + 6, "sA > serA am=0->0xffff " + message) +
         at(ms + 20, "bA < serA am=0->0xffff " + message);
}
std::string peis(int ms, const std::string& message) {
  return at(ms, "bA > peis am=11->12 " + message) + at(ms + 5, "bB < peis am=11->12 " + message);
}
const std::string kEnd = at(4000, "sA > app mote_joined(11:9 type=1 transducers=1 actuators=1)");

std::string fails(const std::string& log) { return found(kBegin + log, Severity::kFail); }
// Judges a log with a mote announced at its end that never asked, so that the log goes on for a
// while.
std::string found_by_end(const std::string& log) {
  std::string all = found(kBegin + log + kEnd, Severity::kInconclusive);
  const std::string end = "J6-ONLY";
  EXPECT_EQ(all.substr(all.size() - std::min(all.size(), end.size())), end);
  all.resize(all.size() - std::min(all.size(), end.size()));
  if (!all.empty()) all.pop_back();
  return all;
}

TEST(PeisWatch, MessagesAreFollowedThroughPeis) {
  const std::string log = up(1000, kToPc) + peis(1025, kToPc) +
                          at(1030, "bB > app received(src=11:2 app_id=5 data=xbeef)");
  EXPECT_EQ(found_by_end(log), "");
}

TEST(PeisWatch, WithoutItNothingIsCertain) {
  EXPECT_EQ(found(kBegin + at(1030, "bB > app received(src=11:2 app_id=5 data=xbeef)"),
                  Severity::kInconclusive),
            "T1-DELIVER");
}

TEST(PeisWatch, WhatComesIsHandedToTheSink) {
  const std::string came = up(1000, kToMote) + peis(1025, kToMote);
  EXPECT_EQ(found_by_end(came + at(1031, "bB > serB am=0->1 " + kToMote)), "");
  EXPECT_EQ(found_by_end(came), "N8-INCOMING");
}

TEST(PeisWatch, AMessageLeavesAsItCame) {
  const std::string came = up(1000, kToMote) + peis(1025, kToMote);
  EXPECT_EQ(fails(came + at(1031, "bB > serB am=0->1 " + kOther)), "N8-INCOMING");
  EXPECT_EQ(fails(came + at(1031, "bB > serB am=0->1 " + kToMote) +
                  at(1050, "bB > serB am=0->1 " + kToMote)),
            "N8-INCOMING");
}

TEST(PeisWatch, WhatTheSinkSendsGoesToPeis) {
  const std::string got = at(510, "bB > app received(src=11:2 app_id=5 data=xbeef)");
  EXPECT_EQ(found_by_end(peis(500, kToPc) + got + up(1000, kToPc) + peis(1025, kToPc)), "N8-PEIS");
  const std::string some = up(900, kOther) + peis(925, kOther);
  const std::string handed = at(935, "bB > serB am=0->1 " + kOther);
  EXPECT_EQ(found_by_end(some + handed + up(1000, kToPc)), "N8-PEIS");
}

// Islands on one air: the sink hears what the other island's sink radiates of its own base station,
// and hands it up, as its src is of the island (N6-ROUTE).
TEST(PeisWatch, ItsOwnMessageMayComeBackAndGoesOn) {
  const std::string own = "am(28 x000cffff000bfffd000077040305beef)";
  const std::string first =
      at(1000, "bA < app send(dest=12:0xffff app_id=5 reliable=0 data=xbeef)") +
      at(1001, "bA > app send_result(0x77)") + peis(1001, own) +
      at(1007, "bB > serB am=0->1 " + own);
  const std::string back =
      at(1020, "sA > serA am=0->0xffff " + own) + at(1030, "bA < serA am=0->0xffff " + own);
  EXPECT_EQ(fails(first + back + peis(1031, own)), "");
  EXPECT_EQ(fails(first + peis(1031, own)), "N2-ONCE");
  EXPECT_NE(found_by_end(first + back).find("N8-PEIS"), std::string::npos);
}

TEST(PeisWatch, ABaseStationWhoseLineIsOffHandsNothingOn) {
  const std::string off =
      at(900, "bB < app interface(link=serial on=off)") + at(900, "bB > app op_result(success)");
  EXPECT_EQ(found_by_end(off + up(1000, kToMote) + peis(1025, kToMote)), "");
}

TEST(PeisWatch, ToTheIslandThatIsMeant) {
  EXPECT_EQ(fails(up(1000, kToPc) + at(1025, "bA > peis am=11->13 " + kToPc)), "N8-PEIS");
}

// A message that must not be on PEIS at all is one finding, however many of its fields are odd.
TEST(PeisWatch, WhatNothingMayPutThereIsOneFinding) {
  const std::string own = "am(28 x000b0002000bfffd010077040305beef)";
  const std::string once = at(1025, "bA > peis am=11->11 " + own);
  EXPECT_EQ(fails(once), "N8-PEIS");
  EXPECT_EQ(fails(once + at(1040, "bA > peis am=11->11 " + own)), "N8-PEIS");
  const std::string there = "am(28 x000c0002000bfffd010077040305beef)";
  EXPECT_EQ(fails(peis(1025, there) + peis(1040, there)), "T3-RESEND");
}

// An ack from another island ends the message; a wrong one does not.
TEST(PeisWatch, AcksOfBaseStationsAreKnown) {
  const std::string sent = at(1000, "bA < app send(dest=12:null app_id=5 reliable=1 data=xbeef)") +
                           at(1000, "bA > app send_result(seq_num=119)") +
                           peis(1001, "am(28 x000cfffd000bfffd010077040305beef)") +
                           at(1006, "bB > app received(src=11:null app_id=5 data=xbeef)");
  const auto ack = [](int ms) {
    const std::string message = "am(28 x000bfffd000cfffd00001106090517007700)";
    return at(ms, "bB > peis am=12->11 " + message) + at(ms + 5, "bA < peis am=12->11 " + message);
  };
  const std::string told = at(1020, "bA > app ack_received(app_id=5 seq_num=119 result=success)");
  EXPECT_EQ(found_by_end(sent + ack(1010) + told), "");
  EXPECT_EQ(found_by_end(sent + told), "T2-ACK T3-SUCCESS");
  EXPECT_EQ(found_by_end(sent + ack(1010)), "T3-SUCCESS");
  EXPECT_EQ(found_by_end(told), "T3-SUCCESS");
}

std::string told(const std::string& island) {
  return "am=0->1 config(type=set_island_id value=" + island + ")";
}

TEST(PeisWatch, ABaseStationTellsItsOwnIsland) {
  std::string begin = kBegin;
  const std::string node = "%node bA base_station island=11";
  begin.insert(begin.find(node) + node.size(), " iut whole");
  const std::string call =
      at(50, "bA < app set_island_id(12)") + at(51, "bA > app op_result(success)");
  const auto fails = [&](const std::string& calls, const std::string& island) {
    const std::string tells = at(100, "bA > serA " + told(island));
    return found(begin + calls + tells + "   @0..2000 bA !> * *\n", Severity::kFail);
  };
  EXPECT_EQ(fails("", "11"), "");
  EXPECT_EQ(fails("", "12"), "N9-SET");
  EXPECT_EQ(fails(call, "12"), "");
}

// A log has both ends of the line: what the base station sends, and what the sink is given.
TEST(PeisWatch, ASinkThatWasToldAnotherIslandActsForIt) {
  const auto answers = [](const std::string& island) {
    return fails(at(90, "bA < app set_island_id(12)") + at(91, "bA > app op_result(success)") +
                 at(100, "bA > serA " + told("12")) + at(110, "sA < serA " + told("12")) +
                 at(1000,
                    "sA < rA am=5->1 join_request(seq_num=7 mote_type=1 transducers=1 "
                    "actuators=1)") +
                 at(1010, "sA > rA am=1->5 join_reply(island_addr=" + island +
                              " mote_addr=5 cur_time=1010 seq_num=7)"));
  };
  EXPECT_EQ(answers("12"), "");
  EXPECT_EQ(answers("11"), "N9-SET");
}

}  // namespace
}  // namespace rubric::check::peis_watch_test
