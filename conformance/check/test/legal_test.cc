// Legal traffic, made by a generator that knows the rules and not this checker: nothing may fail.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/judge/judge.h"
#include "conformance/check/test/frames_testing.h"
#include "conformance/selftest/lawful_traffic/generate.h"
#include "conformance/selftest/lawful_traffic/variants.h"
#include "tools/tests/readme/number.h"

namespace rubric::check {
namespace {

constexpr std::uint64_t kSeeds = 4;
constexpr std::uint64_t kMixedSeeds = 60;

struct Count {
  std::uint64_t judgements = 0;
  FrameSet frames;
  std::uint64_t fails = 0;
};

void judge_one(const lawful::Traffic& traffic, const Options& options, Count& count) {
  RunReader reader;
  std::string error;
  ASSERT_TRUE(reader.add_bytes(traffic.variant, lawful::to_pcapng(traffic), error)) << error;
  const check::Run run = reader.finish();
  const Report report = judge(run, options);
  ++count.judgements;
  add_frames(run, count.frames);
  for (const Finding& finding : report.findings) {
    const bool fails = finding.severity == Severity::kFail;
    count.fails += fails ? 1 : 0;
    EXPECT_FALSE(fails) << traffic.variant << " seed " << traffic.seed << " frame "
                        << finding.place.frame << ": "
                        << reflect::requirement(finding.requirement).id << " " << finding.text;
  }
}

void judge_both(const std::string& variant, std::uint64_t seed, Count& count) {
  const lawful::Traffic traffic = lawful::generate(variant, seed);
  Options options;
  options.stated = stated_by(traffic.stated);
  for (const lawful::NodeInfo& node : traffic.nodes) {
    if (node.role == lawful::Role::kTester) options.testers.push_back(node.id);
  }
  // A host that sends malformed messages on purpose is the tester.
  if (!traffic.all_well_formed) options.testers.push_back(0);
  judge_one(traffic, options, count);
  options.sniffer_complete = traffic.sniffer_complete;
  options.start_cold = traffic.cold_start;
  judge_one(traffic, options, count);
}

TEST(Legal, NothingFails) {
  Count count;
  for (const lawful::Variant& variant : lawful::variants()) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      judge_both(std::string(variant.name), seed, count);
    }
  }
  const std::uint64_t variants = lawful::variants().size();
  for (std::uint64_t seed = 1; seed <= kMixedSeeds; ++seed) judge_both("mixed", seed, count);
  std::printf("%llu legal variants, %llu judgements of %zu frames, %llu false alarms\n",
              static_cast<unsigned long long>(variants),
              static_cast<unsigned long long>(count.judgements), count.frames.size(),
              static_cast<unsigned long long>(count.fails));
  EXPECT_EQ(count.frames.size(), readme_number("alarm in # different frames"));
  EXPECT_GE(variants, 20U);
}

// What is legal since it is stated fails where nothing is.
TEST(Legal, UnstatedItFails) {
  for (const char* name : {"stated_join_timer", "stated_requests", "stated_busy_channel"}) {
    std::size_t fails = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      RunReader reader;
      std::string error;
      ASSERT_TRUE(reader.add_bytes(name, lawful::to_pcapng(lawful::generate(name, seed)), error));
      fails += judge(reader.finish(), {}).verdict == Verdict::kFail;
    }
    EXPECT_GT(fails, 0U) << name;
  }
}

}  // namespace
}  // namespace rubric::check
