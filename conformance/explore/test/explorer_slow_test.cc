#include <gtest/gtest.h>

#include <memory>

#include "conformance/explore/search.h"
#include "conformance/generated/profiles.h"
#include "tools/tests/readme/number.h"

namespace rubric::explore {
namespace {

// Two motes and two sinks, one copy of a frame in flight, loss and duplication.
TEST(ExploreSlow, TwoMotesAndTwoSinks) {
  Progress alone;
  for (const unsigned threads : {1U, 2U}) {
    Options options;
    options.profile = machine::kPaper;
    options.motes = options.sinks = 2;
    options.loss = options.dup = true;
    options.threads = threads;
    const auto nodes = std::make_unique<Nodes>(options);
    const Result result = explore(*nodes);
    EXPECT_TRUE(result.complete) << result.limit;
    EXPECT_FALSE(result.violation);
    EXPECT_EQ(expected_goals(options) & ~result.goals, 0U);
    if (threads == 1) alone = result.progress;
    EXPECT_EQ(result.progress.states, alone.states);
    EXPECT_EQ(result.progress.transitions, alone.transitions);
    EXPECT_EQ(result.progress.states, readme_number("are # states"));
    // Each with several successors: fewer would mean a gap.
    EXPECT_GT(result.progress.transitions, 5 * result.progress.states);
  }
}

TEST(ExploreSlow, ThreeMotes) {
  Options options;
  options.profile = machine::kPaper;
  options.motes = 3;
  options.loss = options.dup = options.prompt = true;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  options.threads = 2;
  const auto nodes = std::make_unique<Nodes>(options);
  const Result result = explore(*nodes);
  EXPECT_TRUE(result.complete) << result.limit;
  EXPECT_FALSE(result.violation);
  EXPECT_EQ(expected_goals(options) & ~result.goals, 0U);
}

TEST(ExploreSlow, TwoMotesWithEveryFault) {
  Options options;
  options.profile = machine::kPaper;
  options.motes = 2;
  options.loss = options.dup = options.reorder = options.collide = true;
  options.reboots = 1;
  options.calls = 2;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  options.threads = 2;
  const auto nodes = std::make_unique<Nodes>(options);
  const Result result = explore(*nodes);
  EXPECT_TRUE(result.complete) << result.limit;
  EXPECT_FALSE(result.violation);
  EXPECT_GT(result.known_weak_states, 0U);
  EXPECT_EQ(expected_goals(options) & ~result.goals, 0U);
}

}  // namespace
}  // namespace rubric::explore
