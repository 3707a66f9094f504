// The machine keeps its promises whatever happens to it; flaws do not.
#include "conformance/selftest/scripts/watch.h"

#include <gtest/gtest.h>

#include <random>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/print.h"

namespace rubric::script {
namespace {

std::string trace_of(const Script& script) {
  runner::SubjectTarget target(std::make_unique<runner::Machine>());
  return trace::print(to_file(script, play(script, target), {"run", {}, {}}));
}

std::string text_of(const std::optional<Broken>& broken) {
  return broken ? broken->text() : "nothing broken";
}

TEST(Watched, TheMachineKeepsItsPromisesInGoldenTraces) {
  for (const CaseScript& each : golden_scripts()) {
    const auto broken = watch(each.script, machine::step);
    EXPECT_FALSE(broken) << each.case_name << ": " << text_of(broken);
  }
}

TEST(Watched, TheMachineKeepsItsPromisesInChangedTraces) {
  std::mt19937 random(11);
  int runs = 0;
  for (const CaseScript& each : golden_scripts()) {
    for (int i = 0; i < 20; ++i, ++runs) {
      std::vector<std::uint8_t> bytes = encode(each.script);
      for (int k = 0; k < 4; ++k) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      }
      const Script changed = decode(Bytes(bytes.data(), bytes.size()));
      const auto broken = watch(changed, machine::step);
      ASSERT_FALSE(broken) << text_of(broken) << "\n" << trace_of(changed);
    }
  }
  EXPECT_GT(runs, 5000);
}

// Golden traces that lead a flaw astray break a promise; except for the flaw that needs two looks
// at the same clock.
TEST(Watched, FlawsBreakPromises) {
  const std::vector<CaseScript> scripts = golden_scripts();
  for (const flaws::Flaw& flaw : flaws::all()) {
    std::optional<Broken> first;
    for (std::size_t i = 0; i < scripts.size() && !first; ++i) {
      first = watch(scripts[i].script, flaw.step);
    }
    if (flaw.seen == flaws::Seen::kTime) {
      EXPECT_FALSE(first) << flaw.name << ": " << text_of(first);
      continue;
    }
    ASSERT_TRUE(first) << flaw.name;
    const bool right =
        std::any_of(first->requirements.begin(), first->requirements.end(), [&](ReqId rule) {
          return std::find(flaw.requirements.begin(), flaw.requirements.end(), rule) !=
                 flaw.requirements.end();
        });
    EXPECT_TRUE(right) << flaw.name << ": " << text_of(first);
  }
}

}  // namespace
}  // namespace rubric::script
