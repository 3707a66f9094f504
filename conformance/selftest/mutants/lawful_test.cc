// No golden trace fails on a lawful variant of the machine. RUBRIC_ALL_RUNS tries more of those
// that chance makes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include "conformance/generated/profiles.h"
#include "conformance/selftest/mutants/hunt.h"
#include "conformance/selftest/mutants/mutant.h"
#include "conformance/trace/events/lines.h"
#include "tools/tests/readme/number.h"

namespace rubric::mutants {
namespace {

// Returns how many of so many that chance makes are tried.
unsigned made(unsigned all) { return std::getenv("RUBRIC_ALL_RUNS") ? all : all / 8; }

std::vector<LawfulVariant> all_variants() {
  std::vector<LawfulVariant> all = lawful_variants();
  for (LawfulVariant& one : stated_variants()) all.push_back(std::move(one));
  return all;
}

// Each one differs from the machine somewhere, as it should.
TEST(Lawful, NoGoldenTraceFails) {
  const Golden golden("conformance/cases");
  std::vector<runner::CaseLog> machine;
  for (const CaseRef& ref : golden.cases()) {
    machine.push_back(run(ref, [] { return std::make_unique<runner::Machine>(); }).log);
  }
  const std::vector<LawfulVariant> variants = all_variants();
  std::set<std::string> names;
  std::size_t weak = 0;
  for (const LawfulVariant& variant : variants) {
    EXPECT_TRUE(names.insert(variant.name).second) << variant.name;
    bool differs = false;
    auto as_machine = machine.begin();
    for (const CaseRef& ref : golden.cases()) {
      const auto result = run(ref, wrapped(variant.step), variant.stated);
      const bool allowed = result.verdict == runner::CaseVerdict::kPass ||
                           result.verdict == runner::CaseVerdict::kSkip ||  // By its statement.
                           (variant.weak && result.verdict == runner::CaseVerdict::kWeak);
      weak += result.verdict == runner::CaseVerdict::kWeak;
      EXPECT_TRUE(allowed) << variant.name << ": " << variant.reading << '\n'
                           << runner::explain(result, ref.file->file_name);
      const bool same = *as_machine++ == result.log;
      differs = differs || (!same && result.verdict != runner::CaseVerdict::kSkip);
    }
    EXPECT_TRUE(differs) << variant.name;
  }
  EXPECT_EQ(variants.size(), readme_number("# unusual but lawful"));
  std::printf("lawful variants: %zu, golden traces: %zu, weak: %zu, failed: 0\n", variants.size(),
              golden.cases().size(), weak);
}

// Adds a back-off of 0.3 to 10 ms before each frame, in many ways.
TEST(Lawful, BackOffFailsNoTrace) {
  const Golden golden("conformance/cases");
  for (std::uint32_t seed = 0; seed < made(40); ++seed) {
    for (const CaseRef& ref : golden.cases()) {
      const auto result =
          run(ref, wrapped(backing_off(seed, 10)), {{trace::ParameterId::kChannelAccess, 30}});
      EXPECT_EQ(result.verdict, runner::CaseVerdict::kPass)
          << "seed " << seed << ": " << runner::explain(result, ref.file->file_name);
    }
  }
}

// One to all parameters, anywhere in their ranges.
trace::Statement random_statement(std::minstd_rand& random) {
  trace::Statement out;
  const bool many = random() % 2 == 0;
  for (const trace::Parameter& one : trace::parameters()) {
    if (random() % (many ? 2 : 8) != 0) continue;
    const std::int64_t most = std::min<std::int64_t>(one.max, one.min + 4000);
    out.push_back({one.id, one.min + static_cast<std::int64_t>(random()) % (most - one.min + 1)});
  }
  return out;
}

TEST(Lawful, NothingThatIsStatedFailsATrace) {
  const Golden golden("conformance/cases");
  std::minstd_rand random(1);
  std::size_t tried = 0;
  const unsigned all = made(100);
  for (unsigned i = 0; i < all; ++i) {
    const trace::Statement stated = random_statement(random);
    if (!events::contradiction(stated).empty()) continue;
    ++tried;
    for (const CaseRef& ref : golden.cases()) {
      const auto result = run(
          ref, [] { return std::make_unique<runner::Machine>(); }, stated);
      EXPECT_TRUE(result.verdict == runner::CaseVerdict::kPass ||
                  result.verdict == runner::CaseVerdict::kSkip)
          << statement_text(stated) << ": " << runner::explain(result, ref.file->file_name);
    }
  }
  EXPECT_GT(tried, all / 2);
}

// The machine with parameters of its own, whatever its configuration says.
class Stubborn : public runner::Machine {
 public:
  explicit Stubborn(trace::Statement kept) : kept_(std::move(kept)) {}
  void start(const machine::Config& config) override {
    machine::Config own = config;
    own.profile = machine::kPaper;
    events::state(own.profile, kept_);
    Machine::start(own);
  }

 private:
  trace::Statement kept_;
};

std::size_t failures(const Golden& golden, const runner::SubjectFactory& make,
                     const trace::Statement& stated) {
  return static_cast<std::size_t>(std::ranges::count_if(golden.cases(), [&](const CaseRef& ref) {
    return run(ref, make, stated).verdict == runner::CaseVerdict::kFail;
  }));
}

// One that states a parameter and keeps the default, or the other way round, is found.
TEST(Lawful, WhatIsStatedMustBeKept) {
  const Golden golden("conformance/cases");
  for (const LawfulVariant& variant : stated_variants()) {
    const trace::ParameterId id = variant.stated.front().id;
    const trace::Statement nothing;
    if (id == trace::ParameterId::kResponse) continue;
    if (id == trace::ParameterId::kChannelAccess) {
      EXPECT_GT(failures(golden, wrapped(variant.step), nothing), 0U) << variant.name;
      continue;
    }
    const auto keeps = [&](const trace::Statement& kept) {
      return [kept] { return std::make_unique<Stubborn>(kept); };
    };
    EXPECT_GT(failures(golden, keeps(nothing), variant.stated), 0U) << variant.name << " stated";
    EXPECT_GT(failures(golden, keeps(variant.stated), nothing), 0U) << variant.name << " kept";
  }
  for (const LawfulVariant& variant : lawful_variants()) {
    if (variant.name != "slow_250") continue;
    EXPECT_EQ(failures(golden, wrapped(variant.step), {}), 0U);
    EXPECT_GT(failures(golden, wrapped(variant.step), {{trace::ParameterId::kResponse, 100}}), 50U);
  }
}

}  // namespace
}  // namespace rubric::mutants
