// Times that an implementation may state, and the assumptions while it does not (decisions 110,
// 125).
#include <gtest/gtest.h>

#include "conformance/check/observation.h"
#include "conformance/check/tests/testing.h"

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
  NetFields net;
  net.dest = {11, machine::kNullDevid};
  net.src = {11, 1};
  script.up(20 + later_ms, net);
  return judge(script.run, options);
}

TEST(Stated, TheResponseTimeIsTheProfilesUnlessStated) {
  Options options;
  options.sniffer_complete = options.start_cold = true;
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
  Script script;
  script.join(0, 11, 2, 100);
  NetFields net;
  net.dest = {11, 1};
  net.src = {11, 2};
  net.reliable = 1;
  net.seq_num = 5;
  script.radio(1000, 2, 1, am::kNet, net.bytes(), 0, true).link_ack();
  NetFields other;
  other.dest = {11, 2};
  other.src = {11, 1};
  other.seq_num = 900;
  script.net(1000 + later_ms, 1, 2, ack ? net.ack(900) : other, 11);
  return judge(script.run, options);
}

TEST(Stated, AResponseCountsFromTheEndOfItsCause) {
  Options options;
  options.sniffer_complete = options.start_cold = true;
  options.response_us = 300'000;
  constexpr double kAirMs = 35 * 0.032;  // 16 bytes, and 19 around them.
  EXPECT_EQ(failures_of(unacked(300 + kAirMs - 0.01, options), "T2-ACK"_rule), 0U);
  EXPECT_EQ(failures_of(unacked(300 + kAirMs + 0.01, options), "T2-ACK"_rule), 1U);
}

TEST(Stated, AnAckThatComesLateIsNotMissing) {
  Options options;
  options.sniffer_complete = options.start_cold = true;
  EXPECT_EQ(failures_of(unacked(320, options), "T2-ACK"_rule), 1U);
  EXPECT_EQ(failures_of(unacked(320, options, true), "T2-ACK"_rule), 0U);
}

// Judges a log in which a node is notified of a timeout `after_ms` after its message.
Report told_early(double after_ms, const Options& options) {
  Script script;
  LoggedNode node;
  node.name = "m2";
  node.id = 2;
  node.application = true;
  script.run.nodes = {node};
  NetFields net;
  net.dest = {11, 3};
  net.src = {11, 2};
  net.reliable = 1;
  net.seq_num = 5;
  script.net(1000, 2, 3, net);
  script.run.seen.back().node = "m2";
  machine::AckReceived told;
  told.app_id = net.app_id;
  told.seq_num = 5;
  told.success = false;
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

}  // namespace
}  // namespace rubric::check
