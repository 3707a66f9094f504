// Symmetry and partial order: the counts that theory predicts, the verdicts without them, and that
// they are not believed where they do not hold.
#include <memory>
#include <string>
#include <vector>

#include "conformance/explore/independence.h"
#include "conformance/explore/sites.h"
#include "conformance/explore/tests/testing.h"
#include "conformance/machine/flaws/flaws.h"

namespace rubric::explore {
namespace {

using machine::Actions;
using machine::Event;
using machine::State;
using machine::Ticks;

Options network(int motes, int sinks, bool symmetry, bool partial_order) {
  Options options = explore::network(motes, sinks);
  options.symmetry = symmetry;
  options.partial_order = partial_order;
  options.states_max = 3'000'000;
  return options;
}

// Motes that share nothing: each state and step of one, with each state of the others.
TEST(Reductions, CountsAreThoseOfTheTheory) {
  for (const int sinks : {1, 2}) {
    const Progress one = run(network(1, sinks, false, false)).progress;
    std::uint64_t ends = 0;
    for (int motes = 2; motes <= (sinks == 1 ? 3 : 2); ++motes) {
      SCOPED_TRACE(std::to_string(motes) + " x " + std::to_string(sinks));
      std::uint64_t others = one.states;
      for (int i = 2; i < motes; ++i) others *= one.states;
      const Result all = run(network(motes, sinks, false, false));
      ASSERT_TRUE(all.complete);
      EXPECT_EQ(all.progress.states, one.states * others);
      EXPECT_EQ(all.progress.transitions, one.transitions * others * static_cast<unsigned>(motes));
      EXPECT_EQ(all.progress.depth - 1, (one.depth - 1) * static_cast<unsigned>(motes));
      EXPECT_EQ(all.represented_states, all.progress.states);
      EXPECT_EQ(all.omission_probability, 0);

      // Orbits make up all states; of one sink they are the multisets of the motes' states.
      const Result orbits = run(network(motes, sinks, true, false));
      EXPECT_EQ(orbits.represented_states, all.progress.states);
      EXPECT_EQ(orbits.progress.depth, all.progress.depth);
      const std::uint64_t n = one.states;
      const std::uint64_t multisets = motes == 2 ? n * (n + 1) / 2 : n * (n + 1) * (n + 2) / 6;
      if (sinks == 1) {
        EXPECT_EQ(orbits.progress.states, multisets);
      }

      // One mote after the other: each of its states, for each way in which those before ended.
      const Result by_mote = run(network(motes, sinks, false, true));
      ASSERT_TRUE(by_mote.by_mote);
      EXPECT_EQ(by_mote.progress.depth, all.progress.depth);
      const std::uint64_t steps = (by_mote.progress.states - 1) / (n - 1);
      EXPECT_EQ((by_mote.progress.states - 1) % (n - 1), 0U);
      if (motes == 2) ends = steps - 1;
      EXPECT_EQ(steps, motes == 2 ? 1 + ends : 1 + ends + ends * ends);
      EXPECT_GT(ends, 1U);
    }
  }
}

TEST(Reductions, OrbitsOfMessagesMakeUpAllStates) {
  for (const auto& [motes, sinks] : {std::pair{1, 2}, std::pair{2, 1}}) {
    std::array<Result, 2> results;
    for (const bool symmetry : {false, true}) {
      Options options = network(motes, sinks, symmetry, true);
      options.scope = Scope::kFull;
      options.dup = false;
      options.profile.join_requests_max = options.profile.ack_join_max = 2;
      results[symmetry] = run(options);
      EXPECT_TRUE(results[symmetry].complete);
      EXPECT_FALSE(results[symmetry].by_mote);  // Motes talk with each other.
    }
    EXPECT_LT(results[1].progress.states, results[0].progress.states);
    EXPECT_EQ(results[1].represented_states, results[0].progress.states);
    EXPECT_EQ(results[1].goals, results[0].goals);
  }
}

TEST(Reductions, CountsDoNotDependOnThreads) {
  for (const bool partial_order : {false, true}) {
    std::vector<Progress> found;
    for (const unsigned threads : {1U, 3U}) {
      Options options = network(2, 2, true, partial_order);
      options.threads = threads;
      found.push_back(run(options).progress);
    }
    EXPECT_EQ(found[0].states, found[1].states);
    EXPECT_EQ(found[0].transitions, found[1].transitions);
    EXPECT_EQ(found[0].depth, found[1].depth);
  }
}

// Each flaw is found, or not, as without reductions, by as short a way; goals are the same.
TEST(Reductions, ChangeNoVerdict) {
  std::size_t found = 0;
  std::size_t by_mote = 0;
  const auto compare = [&](Options options, const std::string& what) {
    SCOPED_TRACE(what);
    options.symmetry = options.partial_order = false;
    const Result plain = run(options);
    for (const int which : {1, 2, 3}) {
      options.symmetry = (which & 1) != 0;
      options.partial_order = (which & 2) != 0;
      const Result reduced = run(options);
      by_mote += reduced.by_mote ? 1 : 0;
      EXPECT_EQ(reduced.complete, plain.complete) << reduced.limit;
      EXPECT_EQ(reduced.step_acted, plain.step_acted);
      ASSERT_EQ(reduced.violation.has_value(), plain.violation.has_value()) << which;
      if (plain.violation) {
        ++found;
        EXPECT_EQ(reduced.violation->violated, plain.violation->violated);
        EXPECT_EQ(reduced.violation->moves.size(), plain.violation->moves.size());
      } else {
        EXPECT_EQ(reduced.goals, plain.goals);
        EXPECT_LE(reduced.progress.states, plain.progress.states);
      }
    }
  };
  for (const auto& [motes, sinks, calls] :
       {std::tuple{1, 2, 2}, std::tuple{2, 1, 1}, std::tuple{2, 2, 1}, std::tuple{2, 1, 2}}) {
    for (const flaws::Flaw& flaw : flaws::all()) {
      if (flaw.seen != flaws::Seen::kJoin) continue;
      Options options = network(motes, sinks, false, false);
      options.calls = static_cast<std::uint8_t>(calls);
      options.profile.join_requests_max = options.profile.ack_join_max = 2;
      options.reorder = calls == 2;
      options.step = flaw.step;
      compare(options,
              std::string(flaw.name) + " " + std::to_string(motes) + " x " + std::to_string(sinks));
    }
  }
  for (const bool reboot : {false, true}) {
    Options options = network(2, 1, false, false);
    options.reboots = reboot ? 1 : 0;
    options.calls = reboot ? 2 : 1;
    options.profile.join_requests_max = options.profile.ack_join_max = 1;
    compare(options, reboot ? "reboots" : "no flaw");
  }
  EXPECT_GT(found, 30U);
  EXPECT_GT(by_mote, 20U);
}

// The known weakness is counted in each state of an orbit.
TEST(Reductions, KnownWeaknessesAreCountedInAllStates) {
  std::vector<std::uint64_t> weak;
  for (const bool symmetry : {false, true}) {
    Options options = network(2, 1, symmetry, false);
    options.reboots = 1;
    options.calls = 2;
    options.profile.join_requests_max = options.profile.ack_join_max = 1;
    weak.push_back(run(options).known_weak_states);
  }
  EXPECT_GT(weak[0], 0U);
  EXPECT_EQ(weak[1], weak[0]);
}

void ignores_mote_3(State& state, Ticks now, const Event& event, Actions& actions) {
  const auto* heard = std::get_if<machine::Heard>(&event);
  if (heard != nullptr && heard->frame.src == kFirstMoteId + 1) return actions.clear();
  machine::step(state, now, event, actions);
}
void second_island_is_deaf(State& state, Ticks now, const Event& event, Actions& actions) {
  const bool heard = std::holds_alternative<machine::Heard>(event);
  if (heard && state.config.island == kFirstIsland + 1) return actions.clear();
  machine::step(state, now, event, actions);
}

TEST(Reductions, WhoTreatsSomeDifferentlyHasNoSymmetry) {
  for (const bool sink : {false, true}) {
    Options options = network(sink ? 1 : 2, sink ? 2 : 1, true, false);
    options.step = sink ? second_island_is_deaf : ignores_mote_3;
    options.properties = bit(Property::kQueuesBounded);
    const Result result = run(options);
    EXPECT_FALSE(result.complete);
    EXPECT_NE(std::string(result.limit).find("--no-symmetry"), std::string::npos);
    EXPECT_EQ(result.progress.depth, 0U);  // Nothing is proved.
    options.symmetry = false;
    EXPECT_TRUE(run(options).complete);
  }
}

TEST(Reductions, WhatMixesMotesUpIsSearchedInFull) {
  for (const flaws::Flaw& flaw : flaws::all()) {
    if (flaw.seen != flaws::Seen::kJoin) continue;
    Options options = network(2, 2, true, true);
    options.step = flaw.step;
    const bool mixes = std::string_view(flaw.name) == "one_pending_seq";
    EXPECT_EQ(motes_are_independent(options), !mixes) << flaw.name;
  }
  const auto independent = [](auto change) {
    Options options = network(2, 1, true, true);
    change(options);
    return motes_are_independent(options);
  };
  EXPECT_TRUE(independent([](Options&) {}));
  EXPECT_TRUE(independent([](Options& o) { o.reboots = 1, o.calls = 2, o.reorder = true; }));
  EXPECT_FALSE(independent([](Options& o) { o.partial_order = false; }));
  EXPECT_FALSE(independent([](Options& o) { o.motes = 1; }));
  EXPECT_FALSE(independent([](Options& o) { o.collide = true; }));
  EXPECT_FALSE(independent([](Options& o) { o.prompt = true; }));
  EXPECT_FALSE(independent([](Options& o) { o.dups = 1; }));
  EXPECT_FALSE(independent([](Options& o) { o.scope = Scope::kFull; }));
  EXPECT_FALSE(independent([](Options& o) { o.busy = true; }));   // Sinks end transmissions.
  EXPECT_FALSE(independent([](Options& o) { o.exact = true; }));  // Lists keep their order.
}

// Motes that ask for ever, and sinks that never answer.
void never_ends(State& state, Ticks now, const Event& event, Actions& actions) {
  if (std::holds_alternative<machine::Heard>(event)) return actions.clear();
  if (std::holds_alternative<machine::TimerDue>(event)) state.join.requests = 1;
  machine::step(state, now, event, actions);
}

TEST(Reductions, MotesThatNeverEndKeepNoOtherFromBeginning) {
  Options options = network(2, 1, true, true);
  options.step = never_ends;
  options.properties = bit(Property::kQueuesBounded);
  const Result result = run(options);
  EXPECT_TRUE(result.by_mote);
  EXPECT_FALSE(result.complete);
  EXPECT_NE(std::string(result.limit).find("--no-partial-order"), std::string::npos);
  options.partial_order = false;
  EXPECT_TRUE(run(options).complete);
}

// Numbers that fit are the state; others are hashed, and say so.
TEST(Reductions, KeysAreExactWhereTheyFit) {
  const Options options = network(3, 2, true, true);
  const auto nodes = std::make_unique<Nodes>(options);
  const auto sites = std::make_unique<Sites>(*nodes);
  Network air(*nodes);
  const Packer packer(*nodes, *sites, air);
  constexpr SiteId kLimit = (1U << 12) - 1;  // 64 bits for five nodes.
  EXPECT_TRUE(packer.key({{0, 1, 2, 3, kLimit - 1}, 0}).exact);
  EXPECT_FALSE(packer.key({{0, 1, 2, 3, kLimit}, 0}).exact);
  EXPECT_FALSE(packer.key({{kLimit, 1, 2, 3, 0}, 0}).exact);
  EXPECT_NE(packer.key({}).bits, 0U);
  EXPECT_NE(packer.key({{1, 0, 0, 0, 0}, 0}).bits, packer.key({{0, 1, 0, 0, 0}, 0}).bits);
}

// The whole network that the project promises, in a second.
TEST(Reductions, ThreeMotesAndTwoSinks) {
  const Result result = holds(network(3, 2, true, true));
  EXPECT_TRUE(result.by_mote);
  EXPECT_EQ(result.omission_probability, 0);
}

}  // namespace
}  // namespace rubric::explore
