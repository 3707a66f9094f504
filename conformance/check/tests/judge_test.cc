// One fault at a time in a run that is right: its rule must find it, and nothing else may be
// blamed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "codec/reflect/requirements.h"
#include "conformance/check/judge/findings.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check {
namespace {

using machine::Address;
using machine::kNullDevid;

NetFields reliable(Address src, Address dest, std::uint16_t seq_num) {
  return message(src, dest, seq_num, 1);
}

// Two motes join at 0 and 100 ms; both have sent something by 300 ms.
Script two_motes() {
  Script script = Script().join(0, 11, 2, 100).join(100, 11, 3, 200);
  script.net(200, 2, 1, update(2, 1)).up(215, update(2, 1).forwarded());
  script.net(250, 3, 1, update(3, 2)).up(265, update(3, 2).forwarded());
  return script;
}
// Lets every node show life at the end.
void end_well(Script& script, double ms) {
  script.net(ms, 2, 1, update(2, 901)).up(ms + 15, update(2, 901).forwarded());
  script.net(ms + 50, 3, 1, update(3, 902)).up(ms + 65, update(3, 902).forwarded());
  script.down(ms + 100, reliable({11, kNullDevid}, {11, 2}, 903));
  script.net(ms + 110, 1, 2, reliable({11, kNullDevid}, {11, 2}, 903), 11);
  script.net(ms + 130, 2, 1, reliable({11, kNullDevid}, {11, 2}, 903).ack(904));
  script.up(ms + 150, reliable({11, kNullDevid}, {11, 2}, 903).ack(904).forwarded());
}

struct Fault {
  const char* name;
  const char* found;  // Rules that are broken, in order.
  void (*make)(Script&);
};

const Fault kFaults[] = {
    {"nothing", "", [](Script&) {}},
    // Joins.
    {"request_to_another_address", "J1-DEST",
     [](Script& s) {
       Payload p;
       put16(p, 300);
       put(p, kDescriptor);
       s.radio(400, 4, 7, am::kJoin, p);
     }},
    {"request_too_early", "J8-PERIOD",
     [](Script& s) { s.request(400, 4, 300).request(850, 4, 300); }},
    {"sixth_request", "J8-LIMIT",
     [](Script& s) {
       for (int i = 0; i < 6; ++i) s.request(400 + 489 * i, 4, 300);
     }},
    {"same_number_in_a_new_call", "J1-SEQ (weak)",
     [](Script& s) {
       for (int i = 0; i < 5; ++i) s.request(400 + 489 * i, 4, 300);
       s.request(3900, 4, 300);
     }},
    {"offer_to_another_id", "J3-ADDRESS J4-ADDRESS (weak)",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 9, 300, 410, 4);
       Payload p;
       put(p, Address{11, 1});
       put(p, Address{11, 9});
       put16(p, 300);
       put(p, kDescriptor);
       s.radio(420, 4, 1, am::kAckJoin, p);
     }},
    {"member_asks_again", "J5-STOP", [](Script& s) { s.request(900, 2, 100); }},
    {"member_asks_with_another_number", "J5-STOP", [](Script& s) { s.request(900, 2, 101); }},
    {"reply_with_another_number", "J3-SEQ",
     [](Script& s) { s.request(400, 4, 300).reply(410, 11, 4, 301, 410); }},
    {"wrong_number_accepted", "J3-SEQ J4-SEQ",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 301, 410).ack_join(420, 11, 4, 300);
     }},
    {"two_replies", "J3-ONCE",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).reply(415, 11, 4, 300, 415);
     }},
    {"reply_without_request", "J3-ONCE", [](Script& s) { s.reply(410, 11, 4, 300, 410); }},
    {"reply_of_another_island", "J3-ADDRESS",
     [](Script& s) {
       s.request(400, 4, 300);
       s.dsn[12 * 65536U + 1] = s.dsn[11 * 65536U + 1];
       Payload p;
       for (const std::uint32_t v : {11U, 5U, 0U, 410U, 300U}) put16(p, v);
       s.radio(410, 1, 4, am::kJoinReply, p, 11);
     }},
    {"clock_stands_still", "J3-TIME",
     [](Script& s) { s.request(1400, 4, 300).reply(1410, 11, 4, 300, 110); }},
    {"listed_mote_answered", "J2-LISTED",
     [](Script& s) {
       s.dsn[2] = 77;  // It was started again.
       s.request(900, 2, 555).reply(910, 11, 2, 555, 910).ack_join(920, 11, 2, 555);
     }},
    {"ack_join_with_another_number", "J4-CONTENT",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).ack_join(420, 11, 4, 301);
     }},
    {"ack_join_with_another_descriptor", "J4-CONTENT",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).ack_join(420, 11, 4, 300, {9, 9, 9});
     }},
    {"ack_join_without_reply", "J4-JOINED",
     [](Script& s) { s.request(400, 4, 300).ack_join(420, 11, 4, 300); }},
    {"ack_join_much_later", "J4-REPEAT",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).ack_join(420, 11, 4, 300);
       s.joined(440, 11, 4).ack_join(1400, 11, 4, 300);
     }},
    {"no_report", "J6-REPORT",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).ack_join(420, 11, 4, 300).link_ack();
     }},
    {"two_reports", "J6-REPEAT", [](Script& s) { s.joined(440, 11, 2); }},
    {"report_without_ack", "J6-ONLY",
     [](Script& s) { s.request(400, 4, 300).reply(410, 11, 4, 300, 410).joined(440, 11, 4); }},
    {"report_of_a_wrong_ack", "J4-CONTENT J6-SEQ",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).ack_join(420, 11, 4, 301);
       s.joined(440, 11, 4);
     }},
    {"report_with_another_descriptor", "J6-CONTENT",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410).ack_join(420, 11, 4, 300);
       s.joined(440, 11, 4, 1, {2, 2, 2});
     }},
    {"message_before_joining", "J11-SEND",
     [](Script& s) {
       s.request(400, 4, 300).net(420, 4, 1, update(4, 5)).up(435, update(4, 5).forwarded());
     }},
    {"message_from_another_address", "N1-SRC",
     [](Script& s) {
       NetFields net = update(2, 5);
       net.src = {12, 2};
       net.dest = {11, kNullDevid};
       s.net(420, 2, 1, net).up(435, net.forwarded());
     }},
    // Addressing.
    {"own_islands_mote_through_sink", "N4-MOTE",
     [](Script& s) {
       s.net(420, 2, 1, reliable({11, 2}, {11, 3}, 5));
     }},
    {"other_island_past_the_sink", "N4-SINK",
     [](Script& s) {
       s.net(420, 2, 3, reliable({11, 2}, {12, 3}, 5));
     }},
    {"local_island_on_the_air", "N3-LOCAL",
     [](Script& s) {
       NetFields net = update(2, 5);
       net.dest.pid = machine::kLocalPid;
       s.net(420, 2, 1, net);
     }},
    {"sink_radiates_for_the_pc", "N6-OWN",
     [](Script& s) {
       s.net(420, 1, 2, reliable({11, 1}, {11, kNullDevid}, 5), 11);
     }},
    // Forwarding.
    {"forwarded_twice", "N6-ONCE",
     [](Script& s) {
       s.net(420, 2, 1, update(2, 5)).up(435, update(2, 5).forwarded());
       s.up(450, update(2, 5).forwarded());
     }},
    {"forwarded_otherwise", "N6-CONTENT",
     [](Script& s) {
       NetFields other = update(2, 5);
       other.body = {7, 8};
       s.net(420, 2, 1, update(2, 5)).up(435, other.forwarded());
     }},
    {"forwarded_out_of_nothing", "N6-ONCE", [](Script& s) { s.up(435, update(2, 5).forwarded()); }},
    {"forwarded_out_of_order", "N2-ORDER",
     [](Script& s) {
       s.net(420, 2, 1, update(2, 5)).net(425, 3, 1, update(3, 6));
       s.up(440, update(3, 6).forwarded()).up(455, update(2, 5).forwarded());
     }},
    {"forwarded_with_another_number", "N6-CONTENT",
     [](Script& s) {
       NetFields net = update(2, 5);
       s.net(420, 2, 1, net);
       net.seq_num = 6;
       s.up(435, net.forwarded());
     }},
    {"message_to_itself", "N4-SELF (weak)",
     [](Script& s) {
       NetFields net = update(2, 5);
       net.dest = net.src;
       s.net(420, 2, 2, net);
     }},
    {"foreign_source_forwarded", "J11-SEND N6-COLLISION",
     [](Script& s) {
       NetFields net = update(66, 5);
       net.dest.pid = net.src.pid = 12;
       s.net(420, 66, 1, net).up(435, net.forwarded());
     }},
    {"malformed_forwarded", "WIRE-NET-PAYLOAD N11-NBYTES",
     [](Script& s) {
       NetFields net = update(2, 5);
       net.nbytes = 90;
       s.net(420, 2, 1, net).up(435, net.forwarded());
     }},
    {"radiated_otherwise", "N7-CONTENT",
     [](Script& s) {
       NetFields net = reliable({11, kNullDevid}, {11, 2}, 5);
       s.down(420, net);
       net.reliable = 0;
       s.net(430, 1, 2, net, 11);
     }},
    {"radiated_to_another", "N7-RADIO",
     [](Script& s) {
       const NetFields net = reliable({11, kNullDevid}, {11, 2}, 5);
       s.down(420, net).net(430, 1, 3, net, 11);
     }},
    {"radiated_twice", "N2-ONCE",
     [](Script& s) {
       NetFields net = reliable({11, kNullDevid}, {11, 2}, 5);
       net.reliable = 0;
       s.down(420, net).net(430, 1, 2, net, 11).net(470, 1, 2, net, 11);
     }},
    {"stale_bytes_radiated", "N7-CONTENT",
     [](Script& s) {
       NetFields net = reliable({11, kNullDevid}, {11, 2}, 5);
       net.reliable = 0;
       s.down(420, net);
       net.size = 60;
       s.net(430, 1, 2, net, 11);
     }},
    {"report_of_another_mote", "J6-CONTENT",
     [](Script& s) {
       s.request(400, 4, 300).reply(410, 11, 4, 300, 410);
       s.ack_join(420, 11, 4, 300).link_ack().joined(440, 11, 4);
       const Bytes whole = s.run.seen.back().frame.payload;
       Payload p(whole.begin(), whole.end());
       p[18] = 9;  // The devid inside.
       s.run.seen.back().frame.payload = s.run.storage->keep(Bytes(p.data(), p.size()));
     }},
    {"island_not_taken", "N9-SET N9-SET N8-LOOP (weak)",
     [](Script& s) {
       s.serial(400, true, am::kConfig, {10, 0, 21}).confirm().request(420, 4, 300);
       Payload p;
       for (const std::uint32_t v : {11U, 4U, 0U, 430U, 300U}) put16(p, v);
       s.radio(430, 1, 4, am::kJoinReply, p, 11);
     }},
    // Acks.
    {"unreliable_acked", "T2-UNRELIABLE",
     [](Script& s) {
       NetFields net = reliable({11, 2}, {11, 3}, 5);
       net.reliable = 0;
       s.net(420, 2, 3, net).net(430, 3, 2, net.ack(6));
     }},
    {"unknown_transport_acked", "T1-UNKNOWN",
     [](Script& s) {
       NetFields net = reliable({11, 2}, {11, 3}, 5);
       NetFields ack = net.ack(6);
       net.trans_id = 99;
       s.net(420, 2, 3, net).net(430, 3, 2, ack);
     }},
    {"acked_by_the_sink_on_the_way", "T2-CONTENT",
     [](Script& s) {
       const NetFields net = reliable({11, kNullDevid}, {11, 2}, 5);
       NetFields ack = net.ack(6);
       ack.src = {11, 1};
       s.down(420, net).net(430, 1, 2, net, 11).up(435, ack);
     }},
    {"acked_by_the_base_station_on_the_way", "T2-CONTENT",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {12, 3}, 5);
       NetFields ack = net.ack(6);
       ack.src = {11, kNullDevid};
       s.net(420, 2, 1, net).up(430, net).down(440, ack).net(450, 1, 2, ack, 11);
     }},
    {"acked_twice", "T2-ONCE",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {11, 3}, 5);
       s.net(420, 2, 3, net).net(430, 3, 2, net.ack(6)).net(440, 3, 2, net.ack(7));
     }},
    {"ack_of_an_ack", "T2-LOOP",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {11, 3}, 5);
       s.net(420, 2, 3, net).net(430, 3, 2, net.ack(6)).net(440, 2, 3, net.ack(6).ack(7));
     }},
    {"ack_of_another_number", "T2-CONTENT",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {11, 3}, 5);
       s.net(420, 2, 3, net).net(430, 3, 2, reliable({11, 2}, {11, 3}, 9).ack(6));
     }},
    {"ack_of_another_app", "T2-CONTENT",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {11, 3}, 5);
       NetFields ack = net.ack(6);
       ack.app_id = 6;
       s.net(420, 2, 3, net).net(430, 3, 2, ack);
     }},
    {"reliable_ack", "T2-CONTENT",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {11, 3}, 5);
       NetFields ack = net.ack(6);
       ack.reliable = 1;
       s.net(420, 2, 3, net).net(430, 3, 2, ack);
     }},
    {"foreign_message_acked", "N4-SINK N5-FOREIGN",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {12, 3}, 5);
       NetFields ack = net.ack(6);
       ack.src = {11, 3};
       s.net(420, 2, 3, net).net(430, 3, 2, ack);
     }},
    {"number_in_use", "N12-REUSE",
     [](Script& s) {
       s.net(420, 2, 3, reliable({11, 2}, {11, 3}, 5));
       s.net(430, 2, 1, update(2, 5)).up(445, update(2, 5).forwarded());
     }},
    {"sent_again_by_itself", "T3-RESEND",
     [](Script& s) {
       const NetFields net = reliable({11, 2}, {11, 3}, 5);
       s.net(420, 2, 3, net).net(720, 2, 3, net).net(730, 3, 2, net.ack(6));
     }},
    // Synaptic channels.
    {"reliable_synaptic_data", "S2-CONTENT",
     [](Script& s) {
       NetFields net = reliable({11, 2}, {11, 3}, 5);
       net.trans_id = component::kSynChannel;
       net.app_id = 11;
       net.body = {0, 0, 0, 0};
       s.net(420, 2, 3, net);
     }},
    {"half_a_float", "S2-CONTENT",
     [](Script& s) {
       NetFields net = reliable({11, 2}, {11, 3}, 5);
       net.reliable = 0;
       net.trans_id = component::kSynChannel;
       net.app_id = 11;
       net.body = {0, 0, 0};
       s.net(420, 2, 3, net);
     }},
};

class Faults : public testing::TestWithParam<Fault> {};

TEST_P(Faults, AreFoundByTheirRule) {
  Script script = two_motes();
  GetParam().make(script);
  end_well(script, 4000);
  const Report report = judge(script.run, complete());
  std::string all;
  for (const Finding& finding : report.findings) all += finding.text + "\n";
  EXPECT_EQ(broken_in(report), GetParam().found) << all;
}

TEST_P(Faults, AreAtMostInconclusiveOrTheSameWithoutKnowledge) {
  Script script = two_motes();
  GetParam().make(script);
  end_well(script, 4000);
  const Report report = judge(script.run, Options{});
  for (const Finding& finding : report.findings) {
    if (finding.severity < Severity::kFail) continue;
    const char* const id = reflect::requirement(finding.requirement).id;
    EXPECT_THAT(GetParam().found, testing::HasSubstr(id)) << finding.text;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Faults, testing::ValuesIn(kFaults),
                         [](const auto& given) { return std::string(given.param.name); });

TEST(Judge, NothingHasNothingWrong) {
  const Report report = judge(check::Run{}, complete());
  EXPECT_EQ(report.verdict, Verdict::kPass);
  EXPECT_EQ(report.frames, 0U);
}

// One timer that is slow is no new call.
TEST(Judge, TheSixthRequestOfASlowTimerIsOneTooMany) {
  Script script;
  for (int i = 0; i < 6; ++i) script.request(1000 * i, 4, 300);
  EXPECT_EQ(broken_in(judge(script.run, complete())), "J8-LIMIT");
}

TEST(Judge, TestersAreNotJudged) {
  Script script = two_motes();
  NetFields net = update(66, 5);
  net.nbytes = 90;
  script.net(420, 66, 1, net);
  Options options = complete();
  EXPECT_EQ(judge(script.run, options).verdict, Verdict::kFail);
  options.testers = {66};
  EXPECT_EQ(rules_of(judge(script.run, options).findings, Severity::kWeak), "");
}

TEST(Judge, EpisodesAreOneFinding) {
  Script script = two_motes();
  for (int i = 0; i < 5; ++i) script.joined(400 + 100 * i, 11, 2);
  const Report report = judge(script.run, complete());
  ASSERT_EQ(rules_of(report.findings, Severity::kFail), "J6-REPEAT");
  EXPECT_EQ(report.findings.back().count, 5U);
  EXPECT_EQ(report.findings.back().last.time_us, 800'000);
}

TEST(Judge, AStandingClockPassesWhenDeployed) {
  Script script = two_motes();
  script.request(1400, 4, 300).reply(1410, 11, 4, 300, 110);
  Options options = complete();
  options.deployed = true;
  const Report report = judge(script.run, options);
  EXPECT_EQ(rules_of(report.findings, Severity::kNote), "N6-CONTENT J3-TIME");
  EXPECT_EQ(report.verdict, Verdict::kPass);
}

// A mote may have joined anew while its frames were missed, but not since it last showed its
// address.
TEST(Judge, AMessageFromAnotherAddressIsJudgedSinceTheLastFromItsOwn) {
  for (const int own : {0, 2}) {
    Script script = two_motes();
    script.dsn[2] += 2;  // Frames of it were missed.
    std::uint16_t number = 5;
    for (int i = 0; i < own; ++i) script.net(400 + 10 * i, 2, 1, update(2, number++));
    NetFields net = update(2, number++);
    net.src = {11, 9};
    script.net(430, 2, 1, net).net(440, 2, 1, update(2, number));
    const Report report = judge(script.run, {});
    const auto found =
        std::find_if(report.findings.begin(), report.findings.end(),
                     [](const Finding& finding) { return finding.requirement == "N1-SRC"_rule; });
    ASSERT_NE(found, report.findings.end());
    EXPECT_EQ(found->severity, own == 0 ? Severity::kInconclusive : Severity::kFail);
  }
}

// It asked with another number, and goes on as before.
TEST(Judge, AMemberThatAskedIsBlamedForThatAlone) {
  const auto asks = [](std::uint16_t island) {
    Script script;
    script.join(0, 11, 2, 100).net(200, 2, 1, update(2, 1)).up(215, update(2, 1).forwarded());
    script.request(900, 2, 101);
    if (island != 0) script.reply(910, island, 2, 101, 910);
    return script;
  };
  for (const std::uint16_t island :
       std::array<std::uint16_t, 2>{0, 12}) {  // Nobody answered; another sink did.
    Script script = asks(island);
    script.net(1600, 2, 1, update(2, 2)).up(1615, update(2, 2).forwarded());
    EXPECT_EQ(found_in(script), "I:J5-STOP F:J5-STOP") << island;
    Script missed = asks(island);  // A later join may have escaped.
    ++missed.dsn[2];
    missed.net(1600, 2, 1, update(2, 2)).up(1615, update(2, 2).forwarded());
    EXPECT_EQ(found_in(missed, false).find("F:"), std::string::npos) << found_in(missed, false);
  }
  Script restarted = asks(12);  // It may have lost its power.
  restarted.ack_join(920, 12, 2, 101).link_ack().joined(940, 12, 2, 2);
  NetFields net = update(2, 2);
  net.dest.pid = net.src.pid = 12;
  restarted.net(1600, 2, 1, net).up(1615, net.forwarded(), 2);
  EXPECT_EQ(found_in(restarted), "I:J5-STOP");
}

// Its timer runs on, with another number for each request, if it did not hear the link ack.
TEST(Judge, AMemberMayAskUntilItHearsThatItsAckJoinCame) {
  Script script = Script().join(0, 11, 2, 100).request(600, 2, 101);
  script.net(700, 2, 1, update(2, 1)).up(715, update(2, 1).forwarded());
  EXPECT_EQ(found_in(script), "I:J5-STOP");
  Script early = Script().join(0, 11, 2, 100).request(300, 2, 101);
  early.net(700, 2, 1, update(2, 1)).up(715, update(2, 1).forwarded());
  EXPECT_EQ(found_in(early), "I:J5-STOP F:J5-STOP");
  script.request(1700, 2, 102).net(2000, 2, 1, update(2, 2)).up(2015, update(2, 2).forwarded());
  EXPECT_EQ(found_in(script), "I:J5-STOP I:J5-STOP F:J5-STOP");
}

TEST(Judge, OneCauseBreaksOneRule) {
  const auto found = [](const Script& script) { return broken_in(judge(script.run, complete())); };
  // A reply with a wrong number answers the request, and the next one has an answer of its own.
  Script script = two_motes();
  for (int i = 0; i < 4; ++i) {
    script.request(1000 + 490.0 * i, 4, 300).link_ack();
    script.reply(1010 + 490.0 * i, 11, 4, 301, static_cast<std::uint32_t>(1010 + 490 * i));
  }
  end_well(script, 5000);
  EXPECT_EQ(found(script), "J3-SEQ");
  // So does one to all.
  Script all = two_motes();
  all.request(1000, 4, 300).link_ack().reply(1010, 11, 4, 300, 1010, machine::kAmBroadcast);
  all.request(1490, 4, 300).link_ack();
  all.request(1495, 5, 400).link_ack().reply(1505, 11, 5, 400, 1505).ack_join(1510, 11, 5, 400);
  all.link_ack().reply(1520, 11, 4, 300, 1520, machine::kAmBroadcast).joined(1530, 11, 5);
  end_well(all, 5000);
  EXPECT_EQ(found(all), "J3-DEST");
  // An ack to the local island is an ack.
  NetFields net = reliable({11, 2}, {11, kNullDevid}, 7);
  Script local = two_motes();
  local.net(1000, 2, 1, net).up(1010, net.forwarded());
  NetFields ack = net.ack(9);
  ack.dest.pid = machine::kLocalPid;
  local.down(1030, ack).confirm();
  EXPECT_EQ(found(local), "N3-LOCAL");
  // An ack of serial_joined is one of an unreliable message.
  Script report;
  net = message({11, 2}, {11, kNullDevid}, 0);
  net.app_id = 10;
  report.join(0, 11, 2, 100).down(100, net.ack(9)).confirm().net(110, 1, 2, net.ack(9), 11);
  EXPECT_EQ(found(report), "T2-UNRELIABLE");
}

// A host sends again what was not confirmed, and the sink acks what comes to it each time.
TEST(Judge, AnAckOfWhatCameAgainIsPrompt) {
  Script script = Script().join(0, 11, 2, 100);
  const NetFields net = reliable({11, kNullDevid}, {11, 1}, 5);
  script.down(2000, net).confirm(false).up(2010, net.ack(9).forwarded());
  --script.serial_number;
  script.down(3000, net).confirm().up(3010, net.ack(10).forwarded());
  EXPECT_EQ(broken_in(judge(script.run, {})), "");
}

// More senders than are followed: their frames blame nobody, and the report says so.
TEST(Judge, SaysWhoIsNotFollowed) {
  constexpr std::uint16_t kFollowed = 4096;
  for (const std::uint16_t more : {std::uint16_t{0}, std::uint16_t{3}}) {
    Script script;
    for (std::uint16_t i = 0; i < kFollowed + more; ++i) {
      script.request(i, static_cast<std::uint16_t>(100 + i), 7);
    }
    const Report report = judge(script.run, {});
    const auto said = std::count(report.facts.begin(), report.facts.end(),
                                 "senders beyond the first 4096: 3 frames on the air, for which "
                                 "nobody is blamed");
    EXPECT_EQ(said, more != 0 ? 1 : 0);
  }
}

// A run may have more lesser findings than are listed; its failures are listed all the same.
TEST(Judge, LesserFindingsKeepNoFailureOut) {
  const std::vector<ClockStep> steady;
  Findings findings(false, steady);
  Finding finding{.requirement = "J1-DEST"_rule, .severity = Severity::kWeak};
  for (std::size_t i = 0; i < Listed::kMost + 7; ++i) {
    finding.place.time_us += Findings::kEpisodeUs + 1;
    findings.add(finding);
  }
  finding.severity = Severity::kFail;
  findings.add(finding);
  EXPECT_EQ(findings.dropped(), 7U);
  EXPECT_EQ(verdict_of(findings.take()), Verdict::kFail);
}

}  // namespace
}  // namespace rubric::check
