#include "conformance/explore/liveness.h"

#include <algorithm>

#include "conformance/explore/counterexample.h"
#include "conformance/explore/tests/testing.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::explore {
namespace {

using machine::Actions;
using machine::Event;
using machine::State;
using machine::Ticks;

Options lively(int motes, int sinks) {
  Options options = network(motes, sinks);
  options.liveness = true;
  options.states_max = 200'000;
  return options;
}

Options messages(int motes, int sinks) {
  Options options = lively(motes, sinks);
  options.scope = Scope::kFull;
  options.dup = false;
  options.profile.join_requests_max = options.profile.ack_join_max = 2;
  return options;
}

bool is_timer(const Event& event, machine::TimerKind kind) {
  const auto* due = std::get_if<machine::TimerDue>(&event);
  return due != nullptr && due->timer.kind == kind;
}

// Asks again and again, and never fails.
void asks_for_ever(State& state, Ticks now, const Event& event, Actions& actions) {
  if (is_timer(event, machine::TimerKind::kJoin)) state.join.requests = 1;
  machine::step(state, now, event, actions);
}

// Waits once more for an ack that did not come.
void waits_for_ever(State& state, Ticks now, const Event& event, Actions& actions) {
  if (!is_timer(event, machine::TimerKind::kAck)) return machine::step(state, now, event, actions);
  actions.clear();
  for (machine::Awaited& one : state.awaited) one.due = now + 1;
}

// Begins the timer of the join anew with each reply to nobody's request, of which a deaf mote has
// one whenever it asks.
void restarts_on_a_reply(State& state, Ticks now, const Event& event, Actions& actions) {
  const auto* heard = std::get_if<machine::Heard>(&event);
  const bool joining = state.join.phase == machine::JoinMote::Phase::kJoining;
  if (heard != nullptr && joining) {
    state.join.requests = 0;
    return actions.clear();
  }
  machine::step(state, now, event, actions);
}

// Walks the path: its loop has to end where it began.
void expect_loop(Nodes& nodes, const Path& path) {
  ASSERT_TRUE(path.loop.has_value());
  ASSERT_LT(*path.loop, path.moves.size());
  Network network(nodes);
  World world = network.initial();
  World begin;
  Successors ways_on;
  const auto same = [](const World& a, const World& b) {
    return a.node == b.node && a.copies == b.copies && a.doubled == b.doubled &&
           std::equal(a.copy.begin(), a.copy.begin() + a.copies, b.copy.begin());
  };
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    if (i == *path.loop) begin = world;
    network.successors(world, ways_on);
    const Move& move = path.moves[i];
    const auto next = std::find_if(ways_on.begin(), ways_on.end(), [&](const Successor& s) {
      return s.move.kind == move.kind && s.move.node == move.node && s.move.what == move.what &&
             s.move.copy == move.copy && s.move.hearers == move.hearers &&
             s.move.stays == move.stays && s.move.confirmed == move.confirmed;
    });
    ASSERT_NE(next, ways_on.end()) << i;
    world = next->world;
  }
  EXPECT_TRUE(same(world, begin));
}

TEST(Liveness, WhatIsBegunEnds) {
  std::uint64_t parts = 0;
  Options rebooted = lively(1, 1);
  rebooted.reboots = 1;
  rebooted.calls = 2;
  for (const Options& options :
       {lively(1, 1), lively(1, 2), lively(2, 1), rebooted, messages(1, 1), messages(1, 2)}) {
    const auto nodes = std::make_unique<Nodes>(options);
    const Liveness found = look_for_loops(*nodes);
    EXPECT_STREQ(found.limit, "");
    EXPECT_FALSE(found.violation);
    EXPECT_GT(found.states, 100U);
    parts += found.parts;
  }
  // There is where one could wait: frames that are heard again and again.
  EXPECT_GT(parts, 100U);
}

// Looks for loops with a flaw. Returns what was found.
Liveness look(Options options, StepFunction step) {
  options.step = step;
  const auto nodes = std::make_unique<Nodes>(options);
  Liveness found = look_for_loops(*nodes);
  EXPECT_STREQ(found.limit, "");
  if (found.violation) expect_loop(*nodes, *found.violation);
  return found;
}

// Who asks for ever is answered in the end, if frames are lost fairly: but not by a sink that lists
// the mote from before its reboot.
TEST(Liveness, AskingForEverEndsUnlessTheSinkIsSilent) {
  EXPECT_FALSE(look(lively(1, 1), asks_for_ever).violation);
  EXPECT_GT(look(lively(1, 1), asks_for_ever).parts, 0U);
  EXPECT_FALSE(look(lively(1, 2), asks_for_ever).violation);
  Options options = lively(1, 1);
  options.reboots = 1;
  options.calls = 2;
  const Liveness found = look(options, asks_for_ever);
  ASSERT_TRUE(found.violation);
  EXPECT_EQ(found.violation->violated, bit(Property::kOneTerminal));
  options.profile.listed_ignored = false;
  EXPECT_FALSE(look(options, asks_for_ever).violation);
  options.profile.listed_ignored = true;
  options.properties = bit(Property::kReliableEnds);
  EXPECT_FALSE(look(options, asks_for_ever).violation);
}

TEST(Liveness, RestartingWithEachReplyIsFound) {
  const Liveness found = look(lively(1, 1), restarts_on_a_reply);
  ASSERT_TRUE(found.violation);
  EXPECT_EQ(found.violation->violated, bit(Property::kOneTerminal));
}

TEST(Liveness, WaitingForEverForAnAckIsFound) {
  for (const Options& options : {messages(1, 1), messages(1, 2)}) {
    const Liveness found = look(options, waits_for_ever);
    ASSERT_TRUE(found.violation);
    EXPECT_EQ(found.violation->violated, bit(Property::kReliableEnds));
  }
  Options options = messages(1, 1);
  options.profile.ack_timeout_ticks = 0;  // Then nobody promises an end.
  EXPECT_FALSE(look(options, machine::step).violation);
}

TEST(Liveness, ALimitIsNoVerdict) {
  Options options = lively(2, 1);
  options.states_max = 100;
  const auto nodes = std::make_unique<Nodes>(options);
  EXPECT_STRNE(look_for_loops(*nodes).limit, "");
}

// The search itself finds no violation here, so that the lasso is its answer.
TEST(Liveness, TheSearchReportsALasso) {
  Options options = messages(1, 1);
  options.step = waits_for_ever;
  options.properties = bit(Property::kReliableEnds);
  const auto nodes = std::make_unique<Nodes>(options);
  const Result result = explore(*nodes);
  ASSERT_TRUE(result.violation);
  EXPECT_FALSE(result.complete);
  EXPECT_GT(result.liveness_states, 0U);
  const std::string text =
      trace::print(counterexample(*nodes, *result.violation, {"paper", "explore.loop", ""}));
  const trace::Parsed parsed = trace::parse(text, "loop.rtr");
  EXPECT_TRUE(parsed.diagnostics.empty()) << text;
  EXPECT_EQ(trace::print(parsed.file), text);
  const std::size_t begin = text.find("; Loop:");
  ASSERT_NE(begin, std::string::npos) << text;
  EXPECT_LT(begin, text.find("; End of the loop")) << text;
  EXPECT_NE(text.find("Broken: reliable_ends"), std::string::npos);
}

}  // namespace
}  // namespace rubric::explore
