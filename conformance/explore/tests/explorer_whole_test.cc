// The largest networks that the project promises to search whole.
#include "conformance/explore/tests/testing.h"
#include "tools/tests/readme/number.h"

namespace rubric::explore {
namespace {

Options large_network(int motes) {
  Options options = network(motes, 2);
  options.threads = 2;
  options.memory_max_bytes = std::uint64_t{4} << 30;
  return options;
}

// Every order of all motes' steps; motes and sinks exchanged. What one mote can do, thrice.
TEST(ExploreWhole, ThreeMotesAndTwoSinks) {
  Options options = large_network(3);
  options.partial_order = false;
  const Result result = holds(options);
  EXPECT_EQ(result.represented_states, readme_number("are # states, all visited"));
  EXPECT_EQ(result.progress.states, readme_number("visited as #"));
  EXPECT_EQ(result.omission_probability, 0);
  options.motes = 1;
  options.symmetry = false;
  const std::uint64_t one = holds(options).progress.states;
  EXPECT_EQ(result.represented_states, one * one * one);
}

TEST(ExploreWhole, MessagesOfTwoMotesAndTwoSinks) {
  Options options = large_network(2);
  options.dup = false;
  options.scope = Scope::kFull;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  const Result result = holds(options);
  EXPECT_LT(result.omission_probability, 1e-3);
}

}  // namespace
}  // namespace rubric::explore
