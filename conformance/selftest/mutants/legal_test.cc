// No golden trace fails on a legal variant of the machine.
#include "conformance/selftest/mutants/legal.h"

#include <gtest/gtest.h>

#include <set>

#include "conformance/selftest/mutants/hunt.h"
#include "tools/tests/readme/number.h"

namespace rubric::mutants {
namespace {

TEST(Legal, NoGoldenTraceFails) {
  const Golden golden("conformance/cases");
  const std::vector<LegalVariant> variants = legal_variants();
  std::set<std::string> names;
  std::size_t weak = 0;
  for (const LegalVariant& variant : variants) {
    EXPECT_TRUE(names.insert(variant.name).second) << variant.name;
    for (const CaseRef& ref : golden.cases()) {
      const auto result = run(ref, wrapped(variant.step));
      const bool allowed = result.verdict == runner::CaseVerdict::kPass ||
                           (variant.weak && result.verdict == runner::CaseVerdict::kWeak);
      weak += result.verdict == runner::CaseVerdict::kWeak;
      EXPECT_TRUE(allowed) << variant.name << ": " << variant.reading << '\n'
                           << runner::explain(result, ref.file->file_name);
    }
  }
  EXPECT_EQ(variants.size(), readme_number("# unusual but legal"));
  std::printf("legal variants: %zu, golden traces: %zu, weak: %zu, failed: 0\n", variants.size(),
              golden.cases().size(), weak);
}

// Each one differs from the machine somewhere, as it should.
TEST(Legal, EachDiffersFromTheMachine) {
  const Golden golden("conformance/cases");
  for (const LegalVariant& variant : legal_variants()) {
    bool differs = false;
    for (const CaseRef& ref : golden.cases()) {
      const auto machine = run(ref, [] { return std::make_unique<runner::Machine>(); });
      const auto other = run(ref, wrapped(variant.step));
      differs = differs || !(machine.log == other.log);
      if (differs) break;
    }
    EXPECT_TRUE(differs) << variant.name;
  }
}

}  // namespace
}  // namespace rubric::mutants
