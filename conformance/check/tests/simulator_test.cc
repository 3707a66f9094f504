// The simulator's networks consist of reference machines: nothing in their logs and captures may
// fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/check/judge/watch.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/frames_testing.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"
#include "conformance/trace/print.h"
#include "tools/tests/readme/number.h"

namespace rubric::check {
namespace {

constexpr std::uint64_t kScenarioSeeds = 3;
constexpr std::uint64_t kFreeSeeds = 20;
constexpr double kDoubled = 0.3;

struct Count {
  std::uint64_t networks = 0;
  std::uint64_t judgements = 0;
  FrameSet frames;
  std::uint64_t fails = 0;
};

void expect_no_fail(const std::string& name, const Run& run, Count& count) {
  const Report report = judge(run, complete());
  EXPECT_GT(report.frames, 0U) << name;
  ++count.judgements;
  for (const Finding& finding : report.findings) {
    if (finding.severity != Severity::kFail) continue;
    ++count.fails;
    ADD_FAILURE() << name << " line " << finding.place.offset_bytes << ", frame "
                  << finding.place.frame << ", " << finding.node << ": "
                  << reflect::requirement(finding.requirement).id << " " << finding.text;
  }
}

void judge_network(const simulate::Scenario& scenario, const simulate::ScenarioOptions& how,
                   Count& count) {
  simulate::Network network = simulate::make_network(scenario, how);
  simulate::CaptureRecorder capture(network);
  simulate::TraceRecorder log(network, scenario.name);
  simulate::Simulation simulation(std::move(network), {&capture, &log});
  simulation.run_until(scenario.length_us);
  char name[160];
  std::snprintf(name, sizeof name, "%s seed %llu motes %zu sinks %zu loss %.1f dup %.1f",
                scenario.name, static_cast<unsigned long long>(how.seed), how.motes, how.sinks,
                how.loss, how.duplication);
  ++count.networks;
  expect_no_fail(std::string(name) + " .rtr", must_read(name, trace::print(log.file())), count);
  Run captured = must_read(name, capture.finish());
  add_frames(captured, count.frames);
  expect_no_fail(std::string(name) + " .pcapng", captured, count);
  // A line in use shows only the sink's own frames.
  std::erase_if(captured.seen, [](const Observation& seen) {
    return seen.kind == Observation::Kind::kSerial && seen.to_mote;
  });
  expect_no_fail(std::string(name) + " one way", captured, count);
}

// News while a run grows, judged every half second.
struct Told {
  std::uint64_t found = 0;
  std::uint64_t withdrawn = 0;
};

void grow(const std::string& name, const Run& whole, Told& told) {
  constexpr std::int64_t kEveryUs = 500'000;
  constexpr std::int64_t kSettleUs = 1'400'000;
  const Options options = complete();
  Watch watch(kSettleUs);
  Run run = whole;
  run.seen.clear();
  for (std::int64_t now_us = kEveryUs; now_us < whole.end_us + 2 * kSettleUs; now_us += kEveryUs) {
    while (run.seen.size() < whole.seen.size() &&
           whole.seen[run.seen.size()].place.time_us <= now_us) {
      run.seen.push_back(whole.seen[run.seen.size()]);
    }
    merge(run);
    for (const Change& change : watch.update(judge(run, options), now_us)) {
      ++(change.what == Change::What::kWithdrawn ? told.withdrawn : told.found);
      EXPECT_NE(change.finding.severity, Severity::kFail)
          << name << " at " << now_us << ": " << change.finding.node << ", frame "
          << change.finding.place.frame << ": " << change.finding.text;
    }
  }
}

void print(const char* what, const Count& count) {
  std::printf("%s: %llu networks, %llu judgements of %zu frames, %llu false alarms\n", what,
              static_cast<unsigned long long>(count.networks),
              static_cast<unsigned long long>(count.judgements), count.frames.size(),
              static_cast<unsigned long long>(count.fails));
}

// Any part of a run can be judged, even one in which half of the nodes are not seen.
TEST(Simulated, PartsOfRunsAreJudged) {
  std::size_t parts = 0;
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    simulate::Network network = simulate::make_network(scenario, {});
    simulate::TraceRecorder log(network, scenario.name);
    simulate::CaptureRecorder capture(network);
    simulate::Simulation simulation(std::move(network), {&capture, &log});
    simulation.run_until(scenario.length_us);
    for (const std::string& bytes : {trace::print(log.file()), capture.finish()}) {
      const check::Run whole = must_read(scenario.name, bytes);
      for (const std::size_t length : {1U, 15U}) {
        for (std::size_t from = 0; from < whole.seen.size(); from += length) {
          check::Run part = whole;
          const std::size_t to = std::min(whole.seen.size(), from + length);
          part.seen.assign(whole.seen.begin() + static_cast<std::ptrdiff_t>(from),
                           whole.seen.begin() + static_cast<std::ptrdiff_t>(to));
          merge(part);
          const Report report = judge(part, {});
          EXPECT_LE(report.frames, length);
          ++parts;
        }
      }
    }
  }
  EXPECT_GT(parts, 1000U);
}

TEST(Simulated, NoFailureIsReportedWhileARunGrows) {
  Told told;
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    for (const double loss : {0.0, 0.2}) {
      simulate::Network network = simulate::make_network(scenario, {2, loss, 0, 3, 2});
      simulate::CaptureRecorder capture(network);
      simulate::Simulation simulation(std::move(network), {&capture});
      simulation.run_until(scenario.length_us);
      grow(scenario.name, must_read(scenario.name, capture.finish()), told);
    }
  }
  std::printf("%llu found, %llu withdrawn\n", static_cast<unsigned long long>(told.found),
              static_cast<unsigned long long>(told.withdrawn));
}

TEST(Simulated, ScenariosDoNotFail) {
  Count count;
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    for (std::uint64_t seed = 1; seed <= kScenarioSeeds; ++seed) {
      judge_network(scenario, {seed, 0, 0, 3, 1}, count);
      judge_network(scenario, {seed, 0, kDoubled, 3, 1}, count);
    }
  }
  print("scenarios", count);
  EXPECT_EQ(count.frames.size(), readme_number("nor in # of the simulator's scenarios"));
  EXPECT_EQ(count.judgements, 6 * kScenarioSeeds * simulate::scenarios().size());
}

TEST(Simulated, FreeNetworksDoNotFail) {
  Count count;
  const simulate::Scenario* const free = simulate::find_scenario("free");
  ASSERT_NE(free, nullptr);
  for (std::size_t motes = 2; motes <= 6; ++motes) {
    for (std::size_t sinks = 1; sinks <= 2; ++sinks) {
      for (std::uint64_t seed = 1; seed <= kFreeSeeds; ++seed) {
        const double loss = 0.1 * static_cast<double>(seed % 4);
        const double duplication = 0.1 * static_cast<double>(seed / 4 % 4);
        judge_network(*free, {seed, loss, duplication, motes, sinks}, count);
      }
    }
  }
  print("free networks", count);
  EXPECT_EQ(count.frames.size(), readme_number("scenarios and # of its free networks"));
  EXPECT_EQ(count.judgements, 3 * 10 * kFreeSeeds);
}

}  // namespace
}  // namespace rubric::check
