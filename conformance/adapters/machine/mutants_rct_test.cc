// The golden traces find every mutant through rct/1 as well as in this process: each runs in a
// process of its own, and talks over pipes.
#include <gtest/gtest.h>

#include <cstdio>

#include "conformance/selftest/mutants/hunt.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/rct_attachment.h"
#include "conformance/test/targets/serve.h"
#include "tools/tests/readme/number.h"

namespace rubric::mutants {
namespace {

using runner::CaseVerdict;
using targets::Process;
using targets::RctAttachment;

const Golden& golden() {
  static const Golden cases("conformance/cases");
  return cases;
}

// Attaches a copy of this process that serves the wrapped machine.
RctAttachment attached(const StepMaker& step) {
  const auto serve = [step](int in_fd, int out_fd) {
    std::FILE* const in = ::fdopen(in_fd, "r");
    std::FILE* const out = ::fdopen(out_fd, "w");
    if (!in || !out) return 1;
    runner::SubjectTarget target(std::make_unique<Wrapped>(step));
    return targets::serve(target, targets::machine_identity(), in, out);
  };
  return RctAttachment([serve] { return Process::copy(serve); }, {});
}

runner::CaseResult run_on(targets::Attachment& attachment, const CaseRef& ref) {
  return runner::run_case(ref.file->file, *ref.one,
                          [&](const trace::NodeHeader&) { return attachment.target(); });
}

// Tries the case that kills it in this process, else any other.
bool killed_through_rct(const Mutant& mutant, const Found& found) {
  RctAttachment attachment = attached(mutant.step);
  for (const bool first : {true, false}) {
    for (const CaseRef& ref : golden().cases()) {
      if ((ref.one->name == found.by) != first) continue;
      const runner::CaseResult result = run_on(attachment, ref);
      const bool died = !result.failures.empty() && result.failures.back().crash;
      EXPECT_FALSE(died || result.verdict == CaseVerdict::kError)
          << mutant.name << ", " << ref.one->name << ": " << result.reason;
      EXPECT_NE(result.verdict, CaseVerdict::kSkip)
          << mutant.name << ", " << ref.one->name << ": " << result.reason;
      if (result.verdict != CaseVerdict::kPass) return true;
    }
  }
  return false;
}

TEST(MutantsRct, WhatIsFoundHereIsFoundThere) {
  Mutants mutants = named_mutants();
  for (Mutant& mutant : generated_mutants(golden())) mutants.push_back(std::move(mutant));
  const std::vector<Found> found = hunt_all(golden(), mutants, 1);
  std::size_t here = 0;
  std::size_t there = 0;
  for (std::size_t i = 0; i < mutants.size(); ++i) {
    if (!found[i].killed) continue;
    ++here;
    const bool killed = killed_through_rct(mutants[i], found[i]);
    there += killed;
    EXPECT_TRUE(killed) << mutants[i].name << " is found in process by " << found[i].by
                        << ", and not through rct/1";
  }
  std::printf("mutants: %zu, killed in process %zu, killed through rct/1 %zu\n", mutants.size(),
              here, there);
  EXPECT_EQ(there, readme_number("they find #"));
}

TEST(MutantsRct, NoLawfulVariantFails) {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t weak = 0;
  const std::vector<LawfulVariant> variants = lawful_variants();
  for (const LawfulVariant& variant : variants) {
    RctAttachment attachment = attached(variant.step);
    for (const CaseRef& ref : golden().cases()) {
      const runner::CaseResult result = run_on(attachment, ref);
      const bool allowed = result.verdict == CaseVerdict::kPass ||
                           (variant.weak && result.verdict == CaseVerdict::kWeak);
      weak += result.verdict == CaseVerdict::kWeak;
      failed += !allowed;
      ++runs;
      EXPECT_TRUE(allowed) << variant.name << ": " << result.reason << '\n'
                           << runner::explain(result, ref.file->file_name);
    }
  }
  std::printf("lawful variants: %zu, runs through rct/1 %zu, weak %zu, failed %zu\n",
              variants.size(), runs, weak, failed);
  // Those that state something are tried in process.
  EXPECT_EQ(variants.size() + stated_variants().size(), readme_number("# unusual but lawful"));
}

// Machines by name, as a user starts them.
TEST(MutantsRct, NamedOnesAreStartedByName) {
  const auto mutant = targets::attach(
      std::string(RUBRIC_MACHINE_ADAPTER) + " --mutant " + named_mutants().front().name, {});
  EXPECT_EQ(mutant->identity().name, "broken_or_unusual");
  const auto lawful = targets::attach(
      std::string(RUBRIC_MACHINE_ADAPTER) + " --lawful " + lawful_variants().front().name, {});
  EXPECT_EQ(lawful->identity().version, lawful_variants().front().name);
  const auto unknown =
      targets::attach(std::string(RUBRIC_MACHINE_ADAPTER) + " --mutant none.such", {});
  EXPECT_THROW(unknown->identity(), runner::TargetBroken);
  EXPECT_EQ(unknown->take_stderr(), "rubric_machine_adapter: no machine is called none.such\n");
}

}  // namespace
}  // namespace rubric::mutants
