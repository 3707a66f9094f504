// Notes of bytes that are no content, and of serial messages without them.
#include <gtest/gtest.h>

#include "conformance/check/judge/sizes.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check {
namespace {

NetFields whole(NetFields net) {
  net.size = machine::kAmPayloadMax;
  return net;
}

Report report_of(const Script& script) { return judge(script.run, complete()); }

TEST(Stale, ExactMessagesHaveNoNote) {
  Script script = Script().join(0, 11, 2, 100);
  script.net(200, 2, 1, update(2, 1)).up(215, whole(update(2, 1)));
  EXPECT_TRUE(report_of(script).findings.empty());
}

TEST(Stale, WhatIsCutShortOnASerialLineIsWeakOnceASender) {
  Script script = Script().join(0, 11, 2, 100).net(200, 2, 1, update(2, 1)).up(215, update(2, 1));
  script.net(2000, 2, 1, update(2, 2)).up(2015, update(2, 2));
  const Report report = report_of(script);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].requirement, "N11-WHOLE"_rule);
  EXPECT_EQ(report.findings[0].severity, Severity::kWeak);
  EXPECT_EQ(report.verdict, Verdict::kWeak);
}

TEST(Stale, SerialLinesAreNotedOnce) {
  Script script = Script().join(0, 11, 2, 100);
  script.net(200, 2, 1, update(2, 1)).up(215, update(2, 1).forwarded());
  const std::uint64_t first = script.run.seen.back().place.frame;
  script.net(2000, 2, 1, update(2, 2)).up(2015, update(2, 2).forwarded());
  const std::uint64_t last = script.run.seen.back().place.frame;
  const Report report = report_of(script);
  ASSERT_EQ(report.findings.size(), 1U);
  const Finding& note = report.findings[0];
  EXPECT_EQ(note.requirement, "N6-CONTENT"_rule);
  EXPECT_EQ(note.severity, Severity::kNote);
  EXPECT_EQ(note.place.frame, first);
  EXPECT_NE(note.text.find("102 bytes where 4 are content"), std::string::npos) << note.text;
  EXPECT_NE(note.text.find("1 more up to frame " + std::to_string(last)), std::string::npos);
  EXPECT_EQ(report.verdict, Verdict::kPass);
}

TEST(Stale, FramesOnTheAirAreNotedOnce) {
  Script script = Script().join(0, 11, 2, 100);
  NetFields net = update(2, 1);
  net.size = 40;
  script.net(200, 2, 1, net).up(215, whole(update(2, 1)));
  const Report report = report_of(script);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].requirement, "WIRE-NET-PAYLOAD"_rule);
  EXPECT_EQ(report.findings[0].severity, Severity::kNote);
  EXPECT_EQ(report.verdict, Verdict::kPass);
}

}  // namespace
}  // namespace rubric::check
