#include <gtest/gtest.h>

#include <memory>

#include "conformance/explore/search.h"
#include "conformance/generated/profiles.h"
#include "tools/tests/readme/number.h"

namespace rubric::explore {
namespace {

// Loss and duplication, one copy of a frame in flight.
Options network(std::uint8_t motes) {
  Options options;
  options.profile = machine::kPaper;
  options.motes = motes;
  options.loss = options.dup = true;
  options.threads = 2;
  return options;
}

// Searches all of it: nothing breaks and every goal is reached.
Result holds(const Options& options) {
  const auto nodes = std::make_unique<Nodes>(options);
  const Result result = explore(*nodes);
  EXPECT_TRUE(result.complete) << result.limit;
  EXPECT_FALSE(result.violation);
  EXPECT_EQ(expected_goals(options) & ~result.goals, 0U);
  return result;
}

TEST(ExploreSlow, TwoMotesAndTwoSinks) {
  Progress alone;
  for (const unsigned threads : {1U, 2U}) {
    Options options = network(2);
    options.sinks = 2;
    options.symmetry = options.partial_order = false;
    options.threads = threads;
    const Result result = holds(options);
    if (threads == 1) alone = result.progress;
    EXPECT_EQ(result.progress.states, alone.states);
    EXPECT_EQ(result.progress.transitions, alone.transitions);
    EXPECT_EQ(result.progress.states, readme_number("two sinks, # states."));
    // Each with several successors: fewer would mean a gap.
    EXPECT_GT(result.progress.transitions, 5 * result.progress.states);
  }
}

TEST(ExploreSlow, ThreeMotes) {
  Options options = network(3);
  options.prompt = true;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  holds(options);
}

TEST(ExploreSlow, TwoMotesWithEveryFault) {
  Options options = network(2);
  options.reorder = options.collide = true;
  options.reboots = 1;
  options.calls = 2;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  EXPECT_GT(holds(options).known_weak_states, 0U);
}

}  // namespace
}  // namespace rubric::explore
