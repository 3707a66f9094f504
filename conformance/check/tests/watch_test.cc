#include "conformance/check/judge/watch.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rubric::check {
namespace {

using What = Change::What;

constexpr std::int64_t kSettleUs = 1000;

Finding finding(std::uint64_t frame, std::string node, Severity severity = Severity::kFail,
                ReqId rule = "J4-SEQ"_rule) {
  Finding out{.requirement = rule, .severity = severity};
  out.place = out.last = {0, frame, 0, static_cast<std::int64_t>(frame) * 100};
  out.node = std::move(node);
  return out;
}

Report report(std::vector<Finding> findings, std::vector<std::string> facts = {}) {
  return {.findings = std::move(findings), .facts = std::move(facts)};
}

TEST(WatchTest, WhatLastsForAWhileIsReportedOnce) {
  Watch watch(kSettleUs);
  const Report one = report({finding(3, "mote 2"), finding(5, "mote 2")});
  EXPECT_TRUE(watch.update(one, 0).empty());
  EXPECT_TRUE(watch.update(one, kSettleUs - 1).empty());
  const std::vector<Change> told = watch.update(one, kSettleUs);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].what, What::kFound);
  EXPECT_EQ(told[0].finding.place.frame, 3u);
  EXPECT_EQ(told[1].finding.place.frame, 5u);
  EXPECT_TRUE(watch.update(one, 10 * kSettleUs).empty());
}

TEST(WatchTest, WhatIsExplainedBeforeIsNeverReported) {
  Watch watch(kSettleUs);
  EXPECT_TRUE(watch.update(report({finding(3, "mote 2")}), 0).empty());
  EXPECT_TRUE(watch.update(report({}), kSettleUs - 1).empty());
  // It holds anew, and its time begins anew.
  EXPECT_TRUE(watch.update(report({finding(3, "mote 2")}), kSettleUs).empty());
  EXPECT_EQ(watch.update(report({finding(3, "mote 2")}), 2 * kSettleUs).size(), 1u);
}

TEST(WatchTest, ASeverityThatChangesIsReported) {
  Watch watch(0);
  EXPECT_EQ(watch.update(report({finding(3, "a", Severity::kInconclusive)}), 0).size(), 1u);
  const std::vector<Change> told = watch.update(report({finding(3, "a")}), 1);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].what, What::kChanged);
  EXPECT_EQ(told[0].before, Severity::kInconclusive);
  EXPECT_EQ(told[0].finding.severity, Severity::kFail);
  EXPECT_TRUE(watch.update(report({finding(3, "a")}), 2).empty());
}

TEST(WatchTest, WhatIsGoneIsWithdrawnWithItsReason) {
  const struct {
    const char* name;
    Report later;
    const char* why;
  } kCases[] = {
      {"Explained", report({}, {"mote 2: 9 frames on the air"}),
       "frames that came later explain it"},
      {"Known", report({}, {"mote 2: 9 frames on the air", "base station of island 12"}),
       "what is known by now: base station of island 12"},
      {"Other", report({finding(3, "mote 4", Severity::kWeak, "J4-ACK"_rule)}),
       "the frame now shows J4-ACK of mote 4"},
  };
  for (const auto& one : kCases) {
    Watch watch(0);
    watch.update(report({finding(3, "mote 2")}, {"mote 2: 4 frames on the air"}), 0);
    const std::vector<Change> told = watch.update(one.later, 1);
    ASSERT_FALSE(told.empty()) << one.name;
    EXPECT_EQ(told[0].what, What::kWithdrawn) << one.name;
    EXPECT_EQ(told[0].finding.node, "mote 2") << one.name;
    EXPECT_EQ(told[0].why, one.why) << one.name;
    EXPECT_EQ(told.size(), 1 + one.later.findings.size()) << one.name;
  }
}

TEST(WatchTest, AnEpisodeThatGrowsOverAFindingIsNotAWithdrawal) {
  Watch watch(0);
  watch.update(report({finding(3, "mote 2"), finding(9, "mote 2")}), 0);
  Finding episode = finding(3, "mote 2");
  episode.count = 3;
  episode.last = finding(9, "mote 2").place;
  EXPECT_TRUE(watch.update(report({episode}), 1).empty());
}

TEST(WatchTest, SeveralOfARuleAndFrameAreReportedEach) {
  Watch watch(0);
  const Report twice = report({finding(3, "mote 2"), finding(3, "mote 2")});
  EXPECT_EQ(watch.update(twice, 0).size(), 2u);
  EXPECT_TRUE(watch.update(twice, 1).empty());
  const std::vector<Change> told = watch.update(report({finding(3, "mote 2")}), 2);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].what, What::kWithdrawn);
}

}  // namespace
}  // namespace rubric::check
