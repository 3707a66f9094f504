// Times that an implementation may state, and the assumptions while it does not (decisions 110,
// 125).
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing.h"
#include "conformance/check/tests/testing_log.h"

namespace rubric::check {
namespace {

constexpr double kTickMs = 1000.0 / 1024;

std::size_t failures_of(const Report& report, ReqId rule) {
  std::size_t count = 0;
  for (const Finding& finding : report.findings) {
    if (finding.requirement == rule && finding.severity == Severity::kFail) ++count;
  }
  return count;
}

// A sink that surely got an ack_join at 20 ms never reports it, and sends another frame `later_ms`
// after it.
Report unreported(double later_ms, const Options& options) {
  Script script;
  script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
  NetFields net{.dest = {11, machine::kNullDevid}, .src = {11, 1}};
  script.up(20 + later_ms, net);
  return judge(script.run, options);
}

TEST(Stated, TheResponseTimeIsTheProfilesUnlessStated) {
  Options options{.sniffer_complete = true, .start_cold = true};
  EXPECT_EQ(failures_of(unreported(299 * kTickMs, options), "J6-REPORT"_rule), 0U);
  EXPECT_EQ(failures_of(unreported(302 * kTickMs, options), "J6-REPORT"_rule), 1U);
  options.response_us = 300'000;
  EXPECT_EQ(failures_of(unreported(302 * kTickMs, options), "J6-REPORT"_rule), 0U);
  // Decision 125 counts from the moment when a node has the frame: its end, more than 1 ms later.
  EXPECT_EQ(failures_of(unreported(301, options), "J6-REPORT"_rule), 0U);
  EXPECT_EQ(failures_of(unreported(302, options), "J6-REPORT"_rule), 1U);
}

// A sink that surely got a reliable message at 1000 ms sends its ack, or another frame and no ack,
// `later_ms` after its start.
Report unacked(double later_ms, const Options& options, bool ack = false) {
  Script script = Script().join(0, 11, 2, 100);
  NetFields net{.dest = {11, 1}, .src = {11, 2}, .reliable = 1, .seq_num = 5};
  script.radio(1000, 2, 1, am::kNet, net.bytes(), 0, true).link_ack();
  NetFields other{.dest = {11, 2}, .src = {11, 1}, .seq_num = 900};
  script.net(1000 + later_ms, 1, 2, ack ? net.ack(900) : other, 11);
  return judge(script.run, options);
}

TEST(Stated, AResponseCountsFromTheEndOfItsCause) {
  Options options{.sniffer_complete = true, .start_cold = true};
  options.response_us = 300'000;
  constexpr double kAirMs = 35 * 0.032;  // 16 bytes, and 19 around them.
  EXPECT_EQ(failures_of(unacked(300 + kAirMs - 0.01, options), "T2-ACK"_rule), 0U);
  EXPECT_EQ(failures_of(unacked(300 + kAirMs + 0.01, options), "T2-ACK"_rule), 1U);
}

TEST(Stated, AnAckThatComesLateIsNotMissing) {
  Options options{.sniffer_complete = true, .start_cold = true};
  EXPECT_EQ(failures_of(unacked(320, options), "T2-ACK"_rule), 1U);
  EXPECT_EQ(failures_of(unacked(320, options, true), "T2-ACK"_rule), 0U);
}

// Judges a log in which a node that states `own` is notified of a timeout `after_ms` after its
// message.
Report told_early(double after_ms, const Options& options, const trace::Statement& own = {}) {
  Script script;
  LoggedNode node{.name = "m2", .id = 2, .stated = own, .application = true};
  script.run.nodes = {node};
  NetFields net{.dest = {11, 3}, .src = {11, 2}, .reliable = 1, .seq_num = 5};
  script.net(1000, 2, 3, net);
  script.run.seen.back().node = "m2";
  machine::AckReceived told{.app_id = net.app_id, .seq_num = 5, .success = false};
  Observation seen = script.run.seen.back();
  seen.kind = Observation::Kind::kNotice;
  seen.notice = &script.run.storage->notices.emplace_back(told);
  seen.place.time_us += static_cast<std::int64_t>(after_ms * 1000);
  ++seen.place.frame;
  script.run.seen.push_back(seen);
  script.run.end_us = seen.place.time_us;
  return judge(script.run, options);
}

TEST(Stated, ATimeoutThatIsTheAssumedOneIsStatedAllTheSame) {
  const auto severity = [](const Report& report) {
    for (const Finding& finding : report.findings) {
      if (finding.requirement == "T3-TIMEOUT"_rule) return finding.severity;
    }
    return Severity::kNote;
  };
  Options options;
  EXPECT_EQ(severity(told_early(500, options)), Severity::kInconclusive);
  EXPECT_EQ(severity(told_early(1000 * kTickMs + 1, options)), Severity::kNote);
  options.ack_timeout_us = 976'563;
  EXPECT_EQ(severity(told_early(500, options)), Severity::kFail);
}

TEST(Stated, WhatTheUserSaysOfAllComesBeforeWhatANodeStates) {
  const auto timeout = [](const Report& report) -> std::string {
    for (const Finding& finding : report.findings) {
      if (finding.requirement == "T3-TIMEOUT"_rule) return finding.expected;
    }
    return "";
  };
  const trace::Statement own = {{trace::ParameterId::kAckTimeout, 2048}};
  EXPECT_EQ(timeout(told_early(1500, {}, own)), "Not before the timeout, 2000.00 ms.");
  EXPECT_EQ(timeout(told_early(2000, {}, own)), "");
  Options users{.stated = {{trace::ParameterId::kAckTimeout, 1024}}};
  EXPECT_EQ(timeout(told_early(500, users, own)), "Not before the timeout, 1000.00 ms.");
  users.ack_timeout_us = 3'000'000;
  EXPECT_EQ(timeout(told_early(2500, users, own)), "Not before the timeout, 3000.00 ms.");
  users = {};
  users.stated = {{trace::ParameterId::kResponse, 100}};
  EXPECT_EQ(timeout(told_early(1500, users, own)), "Not before the timeout, 2000.00 ms.");
}

// Returns who asks too early, by a log of two motes and the sink, beside the capture in which mote
// 3 asks twice, 492 ms apart.
std::string too_early(const std::string& m2, const std::string& m3, const Options& options = {}) {
  const std::string name = "spec/captures/firmware/e1_simultaneous_join.pcapng";
  std::ifstream file(name, std::ios::binary);
  const std::string capture{std::istreambuf_iterator<char>(file), {}};
  const std::string log = "%rtr 1 %profile deployed %tick us\n%node sA sink id=1 island=11\n" +
                          (m2.empty() ? m2 : "%node m2 mote id=2 " + m2 + "\n") +
                          (m3.empty() ? m3 : "%node m3 mote id=3 " + m3 + "\n") + "case e1\n" +
                          at(516250, "sA > app mote_joined(11:2 1 67 1)") +
                          at(1014373, "sA > app mote_joined(11:3 1 67 1)");
  RunReader reader;
  std::string error;
  EXPECT_TRUE(reader.add_bytes(name, capture, error)) << error;
  EXPECT_TRUE(reader.add_bytes("log", log, error)) << error;
  std::string out;
  for (const Finding& finding : judge(reader.finish(), options).findings) {
    if (finding.requirement == "J8-PERIOD"_rule && finding.severity == Severity::kFail) {
      out += finding.node;
    }
  }
  return out;
}

TEST(Stated, ALogStatesNothingOfTheNodesOfACaptureBesideIt) {
  EXPECT_EQ(too_early("", ""), "");
  EXPECT_EQ(too_early("", "join_period=1024"), "mote 3");
  EXPECT_EQ(too_early("join_period=1024", ""), "");
  EXPECT_EQ(too_early("join_period=1024", "join_period=400"), "");
  Options users{.stated = {{trace::ParameterId::kJoinPeriod, 1024}}};
  EXPECT_EQ(too_early("join_period=400", "", users), "mote 3");
  EXPECT_EQ(too_early("", "join_period=400", users), "mote 3");
}

// A header that only names a node says nothing of it that another log says.
TEST(Stated, ANodeIsThatOfTheLogThatHasLinesOfIt) {
  const auto asks = [](int tick, const std::string& mote) {
    return at(tick, "m" + mote + " > rA am=" + mote +
                        "->1 join_request(seq_num=7 mote_type=1 transducers=1 actuators=1)");
  };
  const std::string one = "%rtr 1\n%node m5 mote id=5 iut\n%node m6 mote id=6\ncase one\n" +
                          asks(0, "5") + asks(500, "5");
  const std::string other =
      "%rtr 1\n%node m5 mote id=5\n%node m6 mote id=6 join_period=1000 iut\ncase other\n" +
      asks(100, "6") + asks(600, "6");
  for (const bool turned : {false, true}) {
    RunReader reader;
    std::string error;
    EXPECT_TRUE(reader.add_bytes("one", turned ? other : one, error)) << error;
    EXPECT_TRUE(reader.add_bytes("two", turned ? one : other, error)) << error;
    std::string out;
    for (const Finding& finding : judge(reader.finish(), {}).findings) {
      if (finding.severity == Severity::kFail) out += finding.node;
    }
    EXPECT_EQ(out, "mote 6") << turned;
  }
}

// The host sets the island at 1100 ms; at 2600 ms the sink still forwards for the former one.
TEST(Stated, ASinkTakesItsIslandWithinTheResponseTime) {
  const auto found = [](std::int64_t response_ms) {
    Script script = Script().join(0, 11, 2, 100);
    script.serial(1100, true, am::kConfig, {10, 0, 13}).confirm();
    script.net(2600, 2, 1, update(2, 7)).up(2612, update(2, 7).forwarded());
    return found_in(script, {.start_cold = true, .response_us = 1000 * response_ms});
  };
  EXPECT_EQ(found(2000), "");
  EXPECT_EQ(found(1400), "F:N9-SET");
}

// The clock of a reply is as old as the reply; an older one may be that of a new life, whose list
// is empty.
TEST(Stated, AClockIsBehindByTheResponseTime) {
  const auto found = [](std::int64_t response_ms) {
    Script script;
    script.join(0, 11, 2, 100).serial(500, true, am::kConfig, {1, 0, 0}).confirm();
    script.request(1000, 4, 200).reply(1800, 11, 4, 200, 1010).ack_join(1820, 11, 4, 200);
    script.link_ack().joined(1840, 11, 4);
    script.dsn[2] = 77;
    script.join(2000, 11, 2, 555);
    return found_in(
        script, {.sniffer_complete = true, .start_cold = true, .response_us = 1000 * response_ms});
  };
  EXPECT_EQ(found(1000), "F:J2-LISTED");
  EXPECT_EQ(found(300), "I:J2-LISTED");
}

// How long a sink may be late with a reply (decision 125) is up to the mote that waits for it.
TEST(Stated, AReplyIsMissingOnceTheCallOfItsMoteIsOver) {
  const auto late = [](const std::string& sink, const std::string& mote) {
    const std::string net =
        "net_msg(dest=11:7 src=11:null reliable=0 seq_num=60 "
        "payload.trans_id=connless payload.app_id=mockup payload.payload=x01)";
    return broken_in(judge_log(
        "%rtr 1\n%node sA sink id=1 island=11 " + sink + "\n%node m5 mote id=5 " + mote +
        "\n%node bA base_station island=11\ncase x\n" +
        at(0, "sA < rA am=5->1 join_request(seq_num=300 mote_type=1 transducers=1 actuators=1)") +
        at(4000, "sA < serA am=0->1 " + net) + at(4001, "sA > rA am=1->7 " + net) +
        at(4300,
           "sA > rA am=1->5 join_reply(island_addr=11 mote_addr=5 cur_time=4300 "
           "seq_num=300)")));
  };
  EXPECT_EQ(late("", ""), "J3-REPLY");
  EXPECT_EQ(late("", "join_period=1000"), "");
  EXPECT_EQ(late("join_period=1000", ""), "J3-REPLY");
  EXPECT_EQ(late("join_period=1000", "join_period=500"), "J3-REPLY");
}

}  // namespace
}  // namespace rubric::check
