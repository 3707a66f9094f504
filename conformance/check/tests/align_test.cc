// Captures of one run that were recorded apart.
#include "conformance/check/align/align.h"

#include <gtest/gtest.h>

#include "conformance/check/input/duplicates.h"
#include "conformance/check/tests/align_testing.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"

namespace rubric::check {
namespace {

constexpr const char* kCaptures[] = {"a2_join_data_sensible_start",
                                     "a_join_data",
                                     "b_reliable",
                                     "c_two_islands",
                                     "d1_lose_request",
                                     "d2_lose_reply",
                                     "d3_lose_ack",
                                     "e1_simultaneous_join",
                                     "f_synaptic",
                                     "h10_hdlc_escape_and_bad_serial",
                                     "h4_stale_bytes"};
constexpr double kAhead_s[] = {0, -3600, -1.5, -0.2, -0.03, 0.03, 0.2, 1e6};

std::string simulated(const simulate::Scenario& scenario,
                      const simulate::ScenarioOptions& options) {
  simulate::Network network = simulate::make_network(scenario, options);
  simulate::CaptureRecorder recorder(network);
  simulate::Simulation simulation(std::move(network), {&recorder});
  simulation.run_until(scenario.length_us);
  return recorder.finish();
}

// Returns the worst difference between stamps of the line, apart and in the whole, in ms.
double worst_ms(const check::Run& run, const Apart& apart) {
  const check::Run whole = whole_run(apart);
  std::vector<std::int64_t> times(whole.seen.size() + 1);
  for (const Observation& seen : whole.seen) {
    times.resize(std::max<std::size_t>(times.size(), seen.place.frame + 1));
    times[seen.place.frame] = seen.place.time_us;
  }
  const auto error_us = [&](const Observation& seen) {
    return seen.place.time_us - times[apart.parts[seen.place.file].frames.at(seen.place.frame)];
  };
  std::int64_t zero_us = 0;  // A run's times count from its first frame, whichever that is.
  for (const Observation& seen : run.seen) {
    if (seen.place.file == 0) zero_us = error_us(seen);
  }
  std::int64_t out_us = 0;
  for (const Observation& seen : run.seen) {
    out_us = std::max(out_us, std::abs(error_us(seen) - zero_us));
  }
  return static_cast<double>(out_us) / 1000;
}

double worst = 0;  // Over all tests.

// Expects the same findings apart and in the whole. Where the files could not be aligned, nothing
// fails that the whole does not have. Returns whether they were aligned or needed no alignment.
bool expect_as_whole(const std::string& name, const Apart& parts, const Options& options,
                     bool complete = true) {
  const check::Run run = put_together(parts);
  const std::string fact = aligned_fact(run);
  const bool aligned = fact.find(" is not ") == fact.npos;
  const Report apart = judge(run, options);
  const Report whole = judge(whole_run(parts), options);
  const auto fails = findings_of(apart, &parts, true);
  const auto known = findings_of(whole, nullptr, true);
  for (const std::string& one : fails) {
    EXPECT_TRUE(known.contains(one)) << name << ": " << one << "; " << fact;
  }
  if (!aligned) return false;
  EXPECT_EQ(fails, known) << name << "; " << fact;
  if (!fact.empty()) {
    EXPECT_LT(worst_ms(run, parts), 50) << name << "; " << fact;
    worst = std::max(worst, worst_ms(run, parts));
  }
  if (complete) {
    EXPECT_EQ(findings_of(apart, &parts, false), findings_of(whole, nullptr, false))
        << name << "; " << fact;
  }
  return true;
}

TEST(Align, TheFindingsOfCapturesOfTheFirmwareStay) {
  std::size_t aligned = 0;
  for (const char* name : kCaptures) {
    const std::string bytes = capture(name);
    for (const double ahead_s : kAhead_s) {
      for (const double drift_ppm : {0.0, 50.0}) {
        for (const bool strict : {false, true}) {
          SerialClock clock{.ahead_s = ahead_s, .drift_ppm = drift_ppm};
          Options options{.sniffer_complete = strict, .start_cold = strict};
          const std::string what = std::string(name) + " " + std::to_string(ahead_s) + " s " +
                                   std::to_string(drift_ppm) + " ppm";
          aligned += expect_as_whole(what, take_apart(bytes, clock), options) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GE(aligned, 140U);
}

TEST(Align, TheFindingsOfSimulatedNetworksStay) {
  std::size_t aligned = 0;
  std::size_t all = 0;
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      simulate::ScenarioOptions options{.seed = seed, .loss = 0.1 * static_cast<double>(seed % 2)};
      const std::string bytes = simulated(scenario, options);
      for (const double ahead_s : kAhead_s) {
        for (const double lost : {0.0, 0.2}) {
          for (const double begin_s : {0.0, 10.0}) {
            SerialClock clock;
            clock.ahead_s = ahead_s;
            clock.drift_ppm = seed % 2 == 0 ? 50 : 0;
            clock.lost = lost;
            clock.begin_s = begin_s;
            clock.seed = seed;
            const std::string what = std::string(scenario.name) + " " + std::to_string(seed) +
                                     ", " + std::to_string(ahead_s) + " s, lost " +
                                     std::to_string(lost) + ", from " + std::to_string(begin_s);
            ++all;
            aligned += expect_as_whole(what, take_apart(bytes, clock), {}) ? 1 : 0;
          }
        }
      }
    }
  }
  std::printf("%zu of %zu aligned, stamps within %.3f ms\n", aligned, all, worst);
}

// Two sniffers of one air with their own clocks: their frames are judged once.
TEST(Align, TwoSniffersOfOneAir) {
  SerialClock one;
  SerialClock other{.lost = 0.2, .base_s = one.base_s + 100.123};
  Apart apart = take_apart(capture("a_join_data"), one);
  const Apart second = take_apart(capture("a_join_data"), other);
  const check::Run whole = put_together(apart);
  apart.parts.push_back(second.parts[0]);
  apart.parts.back().name = "second";
  check::Run run = put_together(apart);
  EXPECT_NE(aligned_fact(run).find("second is aligned with radio"), std::string::npos);
  EXPECT_NE(aligned_fact(run).find("100.123000 s ahead"), std::string::npos) << aligned_fact(run);
  std::string error;
  ASSERT_TRUE(drop_duplicates(run, {}, error)) << error;
  EXPECT_EQ(run.seen.size() - whole.seen.size(),
            static_cast<std::size_t>(
                std::count_if(run.seen.begin(), run.seen.end(), [](const Observation& seen) {
                  return seen.place.file == 2 && seen.kind == Observation::Kind::kLinkAck;
                })));
  EXPECT_EQ(findings_of(judge(run, {}), nullptr, false),
            findings_of(judge(whole, {}), nullptr, false));
}

// The lines of two sinks, each on its own clock, given before the air.
TEST(Align, EveryFileHasItsClock) {
  const std::string bytes = capture("c_two_islands");
  SerialClock raw{.stamps = false};
  const Apart by_line = take_apart(bytes, raw);
  ASSERT_EQ(by_line.parts.size(), 3U);
  SerialClock clock;
  Apart apart{.whole = take_apart(bytes, clock).whole};
  for (const std::size_t i : {1U, 2U, 0U}) {
    clock.base_s = 1e9 + 1000.0 * static_cast<double>(i);
    Part part = only_interface(take_apart(bytes, clock).whole, by_line.parts[i].name);
    part.frames = by_line.parts[i].frames;
    apart.parts.push_back(part);
  }
  const check::Run run = put_together(apart);
  EXPECT_EQ(std::count_if(
                run.facts.begin(), run.facts.end(),
                [](const std::string& fact) { return fact.find("is aligned with") != fact.npos; }),
            2);
  EXPECT_EQ(findings_of(judge(run, {}), &apart, false),
            findings_of(judge(whole_run(apart), {}), nullptr, false));
}

// Counts failures of a line without stamps that is in order by common frames; the whole has them
// too.
struct Kept {
  std::size_t runs = 0;
  std::size_t aligned = 0;
  std::size_t fails = 0;  // In wholes.
  std::size_t fails_apart = 0;
  std::size_t fails_before = 0;  // Without alignment.
  std::size_t open = 0;          // Inconclusive ones.
  std::size_t open_before = 0;
};

std::size_t open_of(const Report& report) {
  return static_cast<std::size_t>(std::count_if(
      report.findings.begin(), report.findings.end(),
      [](const Finding& finding) { return finding.severity == Severity::kInconclusive; }));
}

void expect_order(const std::string& name, const Apart& parts, const Options& options, Kept& kept) {
  const check::Run run = put_together(parts);
  const std::string fact = aligned_fact(run);
  const Report apart = judge(run, options);
  const auto fails = findings_of(apart, &parts, true);
  const auto known = findings_of(judge(whole_run(parts), options), nullptr, true);
  for (const std::string& one : fails) {
    EXPECT_TRUE(known.contains(one)) << name << ": " << one << "; " << fact;
  }
  AlignOptions off{.enabled = false};
  const Report before = judge(put_together(parts, off), options);
  ++kept.runs;
  kept.aligned += run.loose.empty() ? 0 : 1;
  kept.fails += known.size();
  kept.fails_apart += fails.size();
  kept.fails_before += findings_of(before, &parts, true).size();
  kept.open += open_of(apart);
  kept.open_before += open_of(before);
}

void print(const char* what, const Kept& kept) {
  std::printf(
      "%s: %zu of %zu in order; %zu failures, %zu without stamps, %zu without order; "
      "%zu inconclusive, %zu without order\n",
      what, kept.aligned, kept.runs, kept.fails, kept.fails_apart, kept.fails_before, kept.open,
      kept.open_before);
}

TEST(Align, ALineWithoutStampsIsInOrderWithTheFirmwaresAir) {
  Kept kept;
  for (const char* name : kCaptures) {
    for (const bool strict : {false, true}) {
      for (const double begin_s : {0.0, 20.0}) {
        SerialClock clock{.stamps = false, .begin_s = begin_s};
        Options options{.sniffer_complete = strict, .start_cold = strict};
        expect_order(name, take_apart(capture(name), clock), options, kept);
      }
    }
  }
  print("firmware", kept);
}

TEST(Align, ALineWithoutStampsIsInOrderWithASimulatedAir) {
  Kept kept;
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      simulate::ScenarioOptions options{.seed = seed, .loss = 0.1 * static_cast<double>(seed % 2)};
      const std::string bytes = simulated(scenario, options);
      for (const double lost : {0.0, 0.2}) {
        SerialClock clock{.stamps = false, .lost = lost, .seed = seed};
        Options strict;
        strict.sniffer_complete = strict.start_cold = lost == 0;
        expect_order(scenario.name, take_apart(bytes, clock), strict, kept);
      }
    }
  }
  print("simulator", kept);
}

}  // namespace
}  // namespace rubric::check
