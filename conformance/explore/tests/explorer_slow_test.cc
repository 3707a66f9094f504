#include "conformance/explore/tests/testing.h"
#include "tools/tests/readme/number.h"

namespace rubric::explore {
namespace {

TEST(ExploreSlow, TwoMotesAndTwoSinks) {
  Progress alone;
  for (const unsigned threads : {1U, 2U}) {
    Options options = network(2, 2);
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
  Options options = network(3, 1);
  options.threads = 2;
  options.prompt = true;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  holds(options);
}

TEST(ExploreSlow, TwoMotesWithEveryFault) {
  Options options = network(2, 1);
  options.threads = 2;
  options.reorder = options.collide = true;
  options.reboots = 1;
  options.calls = 2;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  EXPECT_GT(holds(options).known_weak_states, 0U);
}

}  // namespace
}  // namespace rubric::explore
