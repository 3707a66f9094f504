#include <memory>
#include <string>
#include <vector>

#include "conformance/explore/counterexample.h"
#include "conformance/explore/tests/testing.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::explore {
namespace {

std::string names(Mask mask) { return names_in(mask, properties()); }
std::string goal_names(Mask mask) { return names_in(mask, goals()); }

// Without reductions, which reductions_test.cc is about.
std::unique_ptr<Result> same_with_threads(int motes, int sinks) {
  auto alone = std::make_unique<Result>();
  for (const unsigned threads : {1U, 2U, 3U}) {
    Options options = network(motes, sinks);
    options.symmetry = options.partial_order = false;
    options.threads = threads;
    const Result result = holds(options);
    if (threads == 1) *alone = result;
    EXPECT_EQ(result.progress.states, alone->progress.states);
    EXPECT_EQ(result.progress.transitions, alone->progress.transitions);
    EXPECT_EQ(result.progress.depth, alone->progress.depth);
  }
  return alone;
}

TEST(Explore, CountsDoNotDependOnThreads) {
  const auto small = same_with_threads(1, 1);
  // The numbers change only with the machine's states; find out why.
  EXPECT_EQ(small->progress.states, 101U);
  EXPECT_EQ(small->progress.transitions, 421U);
  EXPECT_EQ(small->progress.depth, 10U);
  // A second sink, unheard, leaves all that was possible, and its one more offer must show.
  const auto two_sinks = same_with_threads(1, 2);
  EXPECT_GT(two_sinks->progress.states, 2 * small->progress.states);
  EXPECT_GT(two_sinks->progress.depth, small->progress.depth);
  // Two motes ignore each other's frames, so every pair of states of one alone occurs.
  const auto two_motes = same_with_threads(2, 1);
  EXPECT_EQ(two_motes->progress.states, small->progress.states * small->progress.states);
}

// States that differ only in their past may be merged: verdict and goals are the same with and
// without.
TEST(Explore, ForgettingThePastChangesNoVerdict) {
  for (const auto& [motes, sinks] : {std::pair{1, 1}, std::pair{1, 2}, std::pair{2, 1}}) {
    for (const flaws::Flaw& flaw : flaws::all()) {
      if (flaw.seen != flaws::Seen::kJoin) continue;
      Options options = network(motes, sinks);
      options.calls = motes == 1 ? 2 : 1;
      options.step = flaw.step;
      const Result merged = run(options);
      options.exact = true;
      const Result exact = run(options);
      ASSERT_EQ(merged.violation.has_value(), exact.violation.has_value()) << flaw.name;
      if (merged.violation) {
        EXPECT_EQ(merged.violation->moves.size(), exact.violation->moves.size()) << flaw.name;
        EXPECT_EQ(names(merged.violation->violated), names(exact.violation->violated));
      } else {
        EXPECT_EQ(goal_names(merged.goals), goal_names(exact.goals)) << flaw.name;
      }
    }
    Options options = network(motes, sinks);
    const Result merged = run(options);
    options.exact = true;
    const Result exact = holds(options);
    EXPECT_EQ(goal_names(merged.goals), goal_names(exact.goals));
    EXPECT_GT(exact.progress.states, merged.progress.states);
  }
}

TEST(Explore, EveryKindOfFaultHolds) {
  std::vector<Options> all;
  const auto with = [&](auto change) {
    Options options = network(1, 2);
    change(options);
    all.push_back(options);
  };
  with([](Options& o) { o.loss = o.dup = false; });
  with([](Options& o) { o.dup = false; });
  with([](Options& o) { o.loss = false; });
  with([](Options& o) { o.reorder = true; });
  with([](Options& o) { o.collide = true; });
  with([](Options& o) { o.prompt = true; });
  with([](Options& o) { o.busy = true; });
  with([](Options& o) { o.in_flight = 2; });
  with([](Options& o) { o.calls = 3; });
  with([](Options& o) { o.loss = o.dup = false, o.collide = o.reorder = true, o.calls = 2; });
  all.push_back(network(1, 3));
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    holds(all[i]);
  }
}

TEST(Explore, RebootedMotesOfTheirSinkAreTheKnownWeakness) {
  Options options = network(1, 1);
  options.reboots = 1;
  options.calls = 2;
  const Result paper = holds(options);
  EXPECT_GT(paper.known_weak_states, 0U);
  EXPECT_TRUE(paper.known_weakness.has_value());
  // A sink that answers its members has no such weakness.
  options.profile.listed_ignored = false;
  const Result answers = run(options);
  EXPECT_FALSE(answers.violation) << names(answers.violation->violated);
  EXPECT_EQ(answers.known_weak_states, 0U);
}

TEST(Explore, DeployedProfileHoldsByItsOwnRules) {
  Options options = network(1, 2);
  options.profile = machine::kDeployed;
  holds(options);
}

TEST(ExploreMessages, Hold) {
  Options options = network(1, 1);
  options.scope = Scope::kFull;
  options.dups = 1;
  holds(options);
  options = network(2, 1);
  options.scope = Scope::kFull;
  options.dup = false;
  options.profile.join_requests_max = 1;
  options.profile.ack_join_max = 1;
  holds(options);
}

struct Found {
  const char* flaw;
  std::uint8_t motes;
  std::uint8_t sinks;
  Property property;
  std::size_t moves;  ///< In the shortest way to break it.
  bool reorder = false;
};

class ExploreFlaws : public testing::TestWithParam<Found> {};

TEST_P(ExploreFlaws, AreFoundByTheShortestTrace) {
  const Found& found = GetParam();
  const flaws::Flaw* const flaw = flaws::find(found.flaw);
  ASSERT_NE(flaw, nullptr);
  Options options = network(found.motes, found.sinks);
  options.calls = 2;
  options.reorder = found.reorder;
  options.properties = bit(found.property);
  if (flaw->seen == flaws::Seen::kMessages) {
    options.scope = Scope::kFull;
    options.dup = false;
  }
  holds(options);  // Not the machine's own.
  options.step = flaw->step;
  const auto nodes = std::make_unique<Nodes>(options);
  const Result result = explore(*nodes);
  ASSERT_TRUE(result.violation.has_value());
  EXPECT_EQ(names(result.violation->violated), info(found.property).name);
  EXPECT_EQ(result.violation->moves.size(), found.moves);
  // The property covers one of the rules that the flaw breaks.
  bool named = false;
  for (const ReqId broken : flaw->requirements) {
    for (const ReqId rule : info(found.property).requirements) {
      named |= broken != ReqId::kNone && broken == rule;
    }
  }
  EXPECT_TRUE(named);
  const std::string text =
      trace::print(counterexample(*nodes, *result.violation, {"paper", "explore.flaw", "A flaw"}));
  const trace::Parsed parsed = trace::parse(text, "counterexample.rtr");
  EXPECT_TRUE(parsed.diagnostics.empty()) << text;
  EXPECT_EQ(trace::print(parsed.file), text);
  EXPECT_NE(text.find(info(found.property).name), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    All, ExploreFlaws,
    testing::Values(Found{"accepts_wrong_seq", 1, 1, Property::kJoinedAfterReply, 9},
                    Found{"one_pending_seq", 2, 1, Property::kAdmitted, 6},
                    Found{"joined_on_link_ack", 1, 1, Property::kJoinedAfterReply, 11},
                    Found{"no_fail", 1, 1, Property::kOneTerminal, 7},
                    Found{"seven_requests", 1, 1, Property::kRequestsBounded, 6},
                    Found{"acks_wrong_seq", 1, 1, Property::kAckRightSeq, 9},
                    Found{"answers_members", 1, 1, Property::kListedSilent, 5, true},
                    Found{"no_ack_timeout", 1, 1, Property::kReliableEnds, 6},
                    Found{"misread_acks", 1, 1, Property::kAckCounts, 7}),
    [](const auto& param) { return std::string(param.param.flaw); });

// Each flaw that is found acted in that network, be it in frames, in state or in signals.
TEST(ExploreFlaws, AllOfTheJoinActWithOldReplies) {
  for (const flaws::Flaw& flaw : flaws::all()) {
    if (flaw.seen != flaws::Seen::kJoin) continue;
    Options options = network(2, 1);
    options.calls = 2;
    options.reorder = true;
    options.properties = 0;
    options.states_max = 20'000;
    options.step = flaw.step;
    EXPECT_TRUE(run(options).step_acted) << flaw.name;
  }
}

// A flaw that no property covers would be a gap.
TEST(ExploreFlaws, AllThatCanBeSeenAreLookedFor) {
  std::size_t seen = 0;
  for (const flaws::Flaw& flaw : flaws::all()) seen += flaw.seen != flaws::Seen::kTime ? 1 : 0;
  EXPECT_EQ(seen, 9U);
}

}  // namespace
}  // namespace rubric::explore
