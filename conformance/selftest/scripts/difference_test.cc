// The machine and the independent node agree as far as the rules decide.
#include "conformance/selftest/scripts/difference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/check.h"
#include "conformance/trace/print.h"

namespace rubric::script {
namespace {

TEST(Difference, NoneInGoldenTraces) {
  std::size_t steps = 0;
  std::size_t compared = 0;
  for (const CaseScript& each : golden_scripts()) {
    const Difference difference = script::difference(each.script);
    EXPECT_EQ(difference.text, "") << each.name() << "\n" << trace::print(difference.file);
    // Here they do exactly the same, so that nothing had to be left open.
    const Script decided = until_free(without_undecided(each.script));
    runner::SubjectTarget target(std::make_unique<runner::Machine>());
    const trace::File file = lenient_file(decided, play(decided, target), {"x", {}, {}});
    const auto wrong = trace::check(file);
    EXPECT_TRUE(wrong.empty()) << each.name() << ": " << wrong[0].text;
    const auto result = runner::run_case(file, file.cases[0],
                                         [](const trace::NodeHeader&) { return cpp_target(); });
    EXPECT_EQ(result.verdict, runner::CaseVerdict::kPass) << runner::explain(result, each.name());
    steps += each.script.steps.size();
    compared += difference.steps;
  }
  std::printf("%zu of %zu steps compared\n", compared, steps);
  EXPECT_GT(compared * 10, steps * 7);  // Free steps must not swallow others.
}

TEST(Difference, NoneInChangedTraces) {
  const std::vector<CaseScript> scripts = golden_scripts();
  std::mt19937 random(3);
  for (int i = 0; i < 4000; ++i) {
    Script script = scripts[random() % scripts.size()].script;
    if (script.steps.empty()) continue;
    const auto some = [&] {
      return script.steps.begin() + static_cast<std::ptrdiff_t>(random() % script.steps.size());
    };
    const Step step = *some();
    script.steps.insert(some(), step);
    some()->delay = static_cast<Ticks>(random() % 3 == 0 ? random() % 1200 : random() % 20);
    script.steps.erase(some());
    const std::vector<std::uint8_t> bytes = encode(script);
    const Difference difference = script::difference(decode(Bytes(bytes.data(), bytes.size())));
    ASSERT_EQ(difference.text, "") << trace::print(difference.file);
  }
}

// The choices that the rules leave hide only flaws that the C++ node's own choices cover.
TEST(Difference, FlawsDiffer) {
  const std::vector<CaseScript> scripts = golden_scripts();
  for (const flaws::Flaw& flaw : flaws::all()) {
    const bool differs = std::any_of(scripts.begin(), scripts.end(), [&](const CaseScript& each) {
      return !difference(each.script, flaw.step).text.empty();
    });
    EXPECT_TRUE(differs) << flaw.name;
  }
}

}  // namespace
}  // namespace rubric::script
