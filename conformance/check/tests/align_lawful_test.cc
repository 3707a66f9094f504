// Lawful traffic, recorded by several clocks: nothing fails, whatever they show.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "conformance/check/tests/align_testing.h"
#include "conformance/check/tests/frames_testing.h"
#include "conformance/check/tests/lawful_testing.h"
#include "conformance/selftest/lawful_traffic/generate.h"
#include "conformance/selftest/lawful_traffic/variants.h"

namespace rubric::check {
namespace {

constexpr std::uint64_t kSeeds = 4;
constexpr std::uint64_t kMixedSeeds = 100;
constexpr double kAhead_s[] = {0, -3600, -1.5, -0.3, 0.2, 1e6};

struct Count {
  std::size_t runs = 0;
  std::size_t aligned = 0;
  std::size_t in_order = 0;
  std::size_t fails = 0;
};

void judge_apart(const std::string& variant, std::uint64_t seed, Count& count) {
  const lawful::Traffic traffic = lawful::generate(variant, seed);
  if (!traffic.has_radio || !traffic.has_serial) return;
  const Options options = options_of_whole(traffic);
  const std::string bytes = lawful::to_pcapng(traffic);
  for (const double ahead_s : kAhead_s) {
    for (const bool stamps : {true, false}) {
      if (!stamps && ahead_s != kAhead_s[0]) continue;
      SerialClock clock{
          .ahead_s = ahead_s, .drift_ppm = static_cast<double>(seed % 3) * 25, .stamps = stamps};
      const check::Run run = put_together(take_apart(bytes, clock));
      const std::string fact = aligned_fact(run);
      ++count.runs;
      count.aligned += fact.find(" ahead (") != fact.npos || fact.find(" behind (") != fact.npos;
      count.in_order += run.loose.empty() ? 0 : 1;
      for (const std::string& one : findings_of(judge(run, options), nullptr, true)) {
        ++count.fails;
        ADD_FAILURE() << variant << " seed " << seed << ", " << ahead_s << " s, "
                      << (stamps ? "stamps" : "no stamps") << ": " << one << "; " << fact;
      }
    }
  }
}

TEST(AlignLawful, NothingFails) {
  Count count;
  for (const lawful::Variant& variant : lawful::variants()) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      judge_apart(std::string(variant.name), seed, count);
    }
  }
  for (std::uint64_t seed = 1; seed <= kMixedSeeds; ++seed) judge_apart("mixed", seed, count);
  std::printf("%zu runs, %zu on one clock, %zu in order without stamps, %zu false alarms\n",
              count.runs, count.aligned, count.in_order, count.fails);
  EXPECT_GT(count.aligned, count.runs / 10);
  EXPECT_GT(count.in_order, count.runs / 30);
}

}  // namespace
}  // namespace rubric::check
