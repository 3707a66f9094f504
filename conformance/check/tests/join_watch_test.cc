// Missing parts of joins, in logs of all that nodes were given; and the clock that a join sets.
#include <gtest/gtest.h>

#include <string>

#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check::join_watch_test {
namespace {

constexpr const char* kBegin = R"(%rtr 1  %profile paper  %tick ms
%node sA sink id=1 island=11
%node m2 mote id=2
%node m3 mote id=3
case log
)";

std::string request(int ms, bool given, int mote = 2) {
  const std::string id = std::to_string(mote);
  const std::string what =
      " am=" + id + "->1 join_request(seq_num=" + id + " mote_type=1 transducers=1 actuators=1)";
  return at(ms, "m" + id + " > rA" + what) + (given ? at(ms + 2, "sA < rA" + what) : "");
}
std::string call(int mote = 2) {
  return at(0, "m" + std::to_string(mote) + " < app join(type=1 transducers=1 actuators=1)");
}
std::string reply(int ms, bool given, int mote = 2) {
  const std::string id = std::to_string(mote);
  const std::string what = " am=1->" + id + " join_reply(island_addr=11 mote_addr=" + id +
                           " cur_time=" + std::to_string(ms) + " seq_num=" + id + ")";
  return at(ms, "sA > rA" + what) + (given ? at(ms + 2, "m" + id + " < rA" + what) : "");
}
std::string ack(int ms, int mote = 2) {
  const std::string id = std::to_string(mote);
  const std::string what = " am=" + id + "->1 ack_join(dest=11:1 src=11:" + id + " seq_num=" + id +
                           " mote_type=1 transducers=1 actuators=1)";
  return at(ms, "m" + id + " > rA" + what) +
         at(ms, "m" + id + " > app joined(11:" + id + " success)") + at(ms + 2, "sA < rA" + what) +
         at(ms + 2, "sA > app mote_joined(11:" + id + " type=1 transducers=1 actuators=1)");
}
std::string joined(int ms, int mote = 2) {
  return request(ms, true, mote) + reply(ms + 4, true, mote) + ack(ms + 8, mote);
}
// Gives something to both nodes, so that the log goes on.
std::string end(int ms) {
  return at(ms, "m2 < rA am=9->0xffff am(9 x01)") + at(ms, "sA < rA am=9->0xffff am(9 x01)");
}
std::string all(const std::string& log) { return found(kBegin + log, Severity::kInconclusive); }
std::string fails(const std::string& log) { return found(kBegin + log, Severity::kFail); }

TEST(JoinWatch, AWholeJoinPasses) { EXPECT_EQ(all(call() + joined(1) + end(3000)), ""); }

TEST(JoinWatch, ARequestThatCameIsAnswered) {
  EXPECT_EQ(fails(call() + request(1, true) + end(400)), "J3-REPLY");
  EXPECT_EQ(all(call() + request(1, true) + end(200)), "") << "There is time left.";
  EXPECT_EQ(all(call() + request(1, false) + end(400)), "") << "It was lost.";
  EXPECT_EQ(all(call() + request(1, true) + at(100, "sA < power reboot") + end(400)), "");
  EXPECT_EQ(all(call() + request(1, true) + at(100, "sA < app interface(radio off)") + end(400)),
            "");
}

TEST(JoinWatch, AListedMoteIsNot) {
  EXPECT_EQ(all(call() + joined(1) + at(600, "m2 < power reboot") +
                at(601, "m2 < app join(type=1 transducers=1 actuators=1)") + request(602, true) +
                end(1000)),
            "");
}

TEST(JoinWatch, EachOfTwoIsAnswered) {
  EXPECT_EQ(fails(call() + call(3) + request(1, true) + request(5, true, 3) + reply(8, true, 3) +
                  ack(12, 3) + end(400)),
            "J9-INTERLEAVE");
}

TEST(JoinWatch, AReplyThatCameIsAcked) {
  const std::string log = call() + request(1, true);
  EXPECT_EQ(fails(log + reply(5, true) + end(400)), "J4-ACK");
  EXPECT_EQ(all(log + reply(5, false) + end(400)), "") << "It was lost.";
  EXPECT_EQ(all(log + reply(5, true) + at(100, "m2 < power off") + end(400)), "");
}

TEST(JoinWatch, ARequestIsRepeated) {
  const std::string log = call() + request(1, false);
  EXPECT_EQ(fails(log + end(900)), "J8-RETRY");
  EXPECT_EQ(all(log + end(700)), "");
  EXPECT_EQ(all(log + request(495, false) + end(1200)), "");
  EXPECT_EQ(all(log + at(300, "m2 < power off") + end(900)), "");
  EXPECT_EQ(fails(log + request(495, false) + end(1500)), "J8-RETRY");
  const std::string four = log + request(495, false) + request(990, false) + request(1480, false);
  EXPECT_EQ(all(four + at(1980, "m2 > app joined(0:0 fail)") + end(5000)), "");
}

TEST(JoinWatch, TheClockIsSet) {
  const std::string log = call() + joined(1) + at(2000, "m2 < app get_clock()");
  EXPECT_EQ(all(log + at(2000, "m2 > app clock(ms=2001)")), "");
  EXPECT_EQ(all(log + at(2000, "m2 > app clock(ms=2900)")), "");
  EXPECT_EQ(fails(log + at(2000, "m2 > app clock(ms=9000)")), "J4-CLOCK");
  EXPECT_EQ(fails(log + at(2000, "m2 > app clock(ms=0)")), "J4-CLOCK");
  EXPECT_EQ(all(at(0, "m2 < app get_clock()") + at(0, "m2 > app clock(ms=77)")), "");
}

// Captures, in which the link's acknowledgement is the proof.
std::string seen(const Script& script, bool complete) {
  Options options{.sniffer_complete = complete, .start_cold = true};
  std::string out;
  for (const Finding& finding : judge(script.run, options).findings) {
    const char* const id = reflect::requirement(finding.requirement).id;
    if (finding.severity == Severity::kFail) out += std::string(id) + " ";
    if (finding.severity == Severity::kInconclusive) out += std::string("(") + id + ") ";
  }
  return out;
}
Script asks(bool link_ack) {
  Script script = Script().join(0, 11, 3, 200);
  Payload request;
  put16(request, 100);
  put(request, kDescriptor);
  script.radio(100, 2, 1, am::kJoin, request, 0, true);
  if (link_ack) script.link_ack();
  return script;
}

TEST(JoinWatch, AMoteThatHasNotJoinedOwesNoAck) {
  const auto message = [](int ms) {
    const std::string what =
        " am=1->2 net_msg(dest=11:2 src=11:1 reliable=1 seq_num=5 nbytes=3 "
        "payload.trans_id=connless payload.app_id=control_layer payload.payload=x01)";
    return at(ms, "sA > rA" + what) + at(ms + 2, "m2 < rA" + what);
  };
  const std::string life =
      at(2000,
         "m2 > rA am=2->1 net_msg(dest=11:1 src=11:2 reliable=0 seq_num=9 nbytes=3 "
         "payload.trans_id=connless payload.app_id=control_layer payload.payload=x01)");
  EXPECT_EQ(fails(call() + request(1, true) + message(4) + reply(8, true) + ack(12) + life), "");
  EXPECT_EQ(fails(call() + joined(1) + message(30) + life), "N5-DELIVER");
}

TEST(JoinWatch, InACaptureALinkAckProvesReception) {
  const auto life = [](Script script) {
    return script.request(700, 4, 300).reply(710, 11, 4, 300, 710);
  };
  EXPECT_EQ(seen(life(asks(true)), true), "J3-REPLY ");
  EXPECT_EQ(seen(life(asks(true)), false), "J3-REPLY ") << "Its DSNs follow each other.";
  EXPECT_EQ(seen(life(asks(false)), true), "(J9-INTERLEAVE) ");
  EXPECT_EQ(seen(asks(true), true), "(J3-REPLY) ") << "Nothing shows that it lives.";
}

// The log of a mote shows that it joins an island whose join_reply is in no capture.
TEST(JoinWatch, AReplyThatEscapedIsNoOthers) {
  const auto joins = [](std::uint16_t acked, double ack_ms, bool complete) {
    Script script = Script().request(10, 2, 100).reply(30, 11, 2, 100, 30);
    script.ack_join(ack_ms, acked, 2, 100).link_ack();
    script.net(2000, 2, 1, message({acked, 2}, {acked, 1}, 7));
    return found_beside(script,
                        m2(0, "< app join(type=1 transducers=1 actuators=1)") +
                            m2(40, "> app joined(12:2 success)"),
                        complete);
  };
  const auto blames = [](const std::string& found) {
    return found.find("F:J5-SUCCESS") != std::string::npos;
  };
  EXPECT_FALSE(blames(joins(12, 45, false))) << joins(12, 45, false);
  EXPECT_TRUE(blames(joins(12, 45, true))) << joins(12, 45, true);
  EXPECT_TRUE(blames(joins(11, 35, false))) << joins(11, 35, false);
}

// The first requests of a call may have escaped; a call that ends too early is found all the same.
TEST(JoinWatch, ACallLastsAsLongAsItsRequestsThatEscaped) {
  const auto fails = [](int ms, bool complete) {
    Script script;
    script.join(0, 11, 3, 100).request(4498, 2, 500).request(4986, 2, 500).request(5474, 2, 500);
    script.net(7000, 3, 1, message({11, 3}, {11, 1}, 7));
    return found_beside(
        script,
        m2(4000, "< app join(type=1 transducers=1 actuators=1)") + m2(ms, "> app joined(0:0 fail)"),
        complete);
  };
  EXPECT_EQ(fails(5970, false).find("F:J8-FAIL"), std::string::npos) << fails(5970, false);
  EXPECT_NE(fails(5970, true).find("F:J8-FAIL"), std::string::npos) << fails(5970, true);
  EXPECT_NE(fails(5500, false).find("F:J8-FAIL"), std::string::npos) << fails(5500, false);
}

// Returns a capture of five requests, 488 ms apart, that nobody answers.
Script five_requests(double ms) {
  Script script = Script().join(0, 11, 3, 100);
  for (int i = 0; i < 5; ++i) script.request(ms + 488 * i, 2, 500);
  return script.net(9000, 3, 1, message({11, 3}, {11, 1}, 7));
}

TEST(JoinWatch, ALogThatEndsBeforeACallOwesNoEvent) {
  const std::string call = m2(4000, "< app join(type=1 transducers=0x43 actuators=1)");
  const auto until = [&](int ms) {
    return found_beside(five_requests(4010), call + m2(ms, "< app get_interface(radio)"), true);
  };
  EXPECT_EQ(until(6000).find("F:"), std::string::npos) << until(6000);
  EXPECT_NE(until(8000).find("F:J8-FAIL"), std::string::npos) << until(8000);
}

// Nothing had happened before the run, but a call before its log begins.
TEST(JoinWatch, ALogThatBeginsLateHasNoCallFromBefore) {
  const auto from = [](int ms) {
    return found_beside(five_requests(4010),
                        m2(ms, "< app get_interface(radio)") + m2(6500, "> app joined(0:0 fail)") +
                            m2(8000, "< app join(type=1 transducers=0x43 actuators=1)"),
                        true);
  };
  EXPECT_EQ(from(5000).find("F:J5-ONCE"), std::string::npos) << from(5000);
  EXPECT_NE(from(0).find("F:J5-ONCE"), std::string::npos) << from(0);
}

// The capture lacks the first ack_join, and has a repeat after the event that tells of it.
TEST(JoinWatch, AnEventBeforeARepeatedAckJoinIsItsEvent) {
  const auto told = [](int ms) {
    Script script = Script().request(10, 2, 100).reply(20, 11, 2, 100, 20);
    ++script.dsn[2];
    script.ack_join(40, 11, 2, 100).link_ack().joined(60, 11, 2);
    script.join(1000, 11, 3, 200).net(2000, 2, 1, message({11, 2}, {11, 1}, 7));
    const std::string event = "> app mote_joined(11:2 type=1 transducers=0x43 actuators=1)";
    return found_beside(
        script,
        (ms < 0 ? "" : at(ms, "sA " + event)) +
            at(1030, "sA > app mote_joined(11:3 type=1 transducers=0x43 actuators=1)") +
            at(2000, "sA < app get_interface(radio)"),
        false, "sA sink id=1 island=11");
  };
  EXPECT_EQ(told(30).find("F:"), std::string::npos) << told(30);
  EXPECT_EQ(told(45).find("F:"), std::string::npos) << told(45);
  EXPECT_NE(told(-1).find("F:J6-ADD"), std::string::npos) << told(-1);
}

TEST(JoinWatch, BeforeTheFirstFrameOfARunOneMayHaveEscaped) {
  Script script = Script().ack_join(0, 11, 2, 100).link_ack().joined(20, 11, 2);
  script.net(1000, 2, 1, message({11, 2}, {11, 1}, 7));
  const auto rules = [&](bool complete) {
    const Options options{.sniffer_complete = complete, .start_cold = true};
    return rules_of(judge(script.run, options).findings, Severity::kFail);
  };
  EXPECT_EQ(rules(false), "");
  EXPECT_NE(rules(true).find("J4-JOINED"), std::string::npos) << rules(true);
}

// The sinks of two islands have one address. Of a reply that offers another island only the gap in
// the DSNs of the one that is seen tells that it may be its own.
TEST(SinkIslands, AReplyThatMayBeTheOnlySinksOwnIsDoubted) {
  Script script;
  script.join(0, 11, 2, 100).request(1000, 3, 200);
  const Payload wrong = {0, 99, 0, 3, 0, 0, 3, 242, 0, 200};
  script.radio(1010, 1, 3, am::kJoinReply, wrong, 11).join(2000, 11, 4, 300);
  const Report report = judge(script.run, {});
  EXPECT_TRUE(failures_of(report).empty());
  EXPECT_NE(rules_of(report.findings, Severity::kInconclusive).find("J3-ADDRESS"),
            std::string::npos)
      << rules_of(report.findings);
  const Report given = judge(script.run, {.nodes = {{1, machine::Role::kSink, 99}}});
  EXPECT_EQ(rules_of(given.findings).find("J3-ADDRESS"), std::string::npos);
}

std::string fails(const Script& script, const Options& options = {}) {
  return rules_of(judge(script.run, options).findings, Severity::kFail);
}

// Mote 2 joins and sends messages; `misses`: one more than the capture has.
Script busy(bool misses) {
  Script script = Script().join(0, 11, 2, 100).join(60, 12, 3, 200, 2);
  for (std::uint16_t i = 1; i <= 12; ++i) {
    if (i == 6 && misses) ++script.dsn[2];
    script.net(100 + 40 * i, 2, 1, update(2, i)).up(110 + 40 * i, update(2, i).forwarded());
  }
  return script;
}

// The link repeats a request, and the capture misses one of the two, which no DSN shows.
TEST(JoinCopies, AReplyMayAnswerTheOneThatIsMissing) {
  const auto with = [](int doubled, bool misses) {
    Script script = busy(misses);
    for (std::uint16_t mote = 4; mote <= 6; ++mote) {
      const std::uint16_t ms = 600 * mote;
      script.request(ms, mote, 300).reply(ms + 10, 11, mote, 300, ms + 10);
      if (mote < 4 + doubled) script.reply(ms + 18, 11, mote, 300, ms + 18);
      script.ack_join(ms + 30, 11, mote, 300).link_ack().joined(ms + 50, 11, mote);
    }
    return script;
  };
  EXPECT_EQ(fails(with(1, true)), "");
  EXPECT_EQ(fails(with(1, false)), "J3-ONCE") << "Nothing else is missing.";
  EXPECT_EQ(fails(with(1, true), {.sniffer_complete = true}), "J3-ONCE");
  EXPECT_EQ(fails(with(3, true)), "J3-ONCE") << "So many are not missing.";
  for (const bool misses : {true, false}) {  // The first copy of a later request.
    Script later = busy(misses);
    later.request(1000, 4, 300).reply(1010, 11, 4, 300, 1010).reply(1495, 11, 4, 300, 1495);
    later.request(1500, 4, 300).reply(1510, 11, 4, 300, 1510);
    later.ack_join(1520, 11, 4, 300).link_ack().joined(1540, 11, 4);
    EXPECT_EQ(fails(later), misses ? "" : "J3-ONCE");
  }
}

// A mote takes an offer that was captured too early, as its request or the offer was repeated.
TEST(JoinCopies, AnOfferMayComeBeforeTheRequestOrAfterItsAck) {
  const auto with = [](double offered_ms, bool misses, const Options& options = {}) {
    Script script = busy(misses);
    if (offered_ms < 1000) script.reply(offered_ms, 12, 4, 300, 900);
    script.request(1000, 4, 300).reply(1010, 11, 4, 300, 1010).ack_join(1020, 12, 4, 300);
    script.link_ack().joined(1025, 12, 4, 2);
    if (offered_ms > 1000) script.reply(offered_ms, 12, 4, 300, 900);
    script.net(1500, 1, 9, message({11, 1}, {11, 9}, 5), 11);  // Nothing of the sinks is missing.
    script.net(1500, 1, 9, message({12, 1}, {12, 9}, 5), 12);
    return fails(script, options);
  };
  EXPECT_EQ(with(995, false), "");
  EXPECT_EQ(with(850, false), "J7-CHOICE");
  EXPECT_NE(with(995, false, {.sniffer_complete = true}).find("J7-CHOICE"), std::string::npos);
  EXPECT_EQ(with(1030, true), "");
  EXPECT_EQ(with(1030, false), "J7-CHOICE") << "Nothing else is missing.";
  EXPECT_EQ(with(1200, true), "J7-CHOICE");
}

}  // namespace
}  // namespace rubric::check::join_watch_test
