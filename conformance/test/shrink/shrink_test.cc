#include "conformance/test/shrink/shrink.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "conformance/selftest/mutants/mutant.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/check.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/print.h"

namespace rubric::shrink {
namespace {

using runner::CaseVerdict;

Player player(runner::SubjectFactory make, std::string profile = "") {
  return {
      [make](const trace::NodeHeader&) { return std::make_unique<runner::SubjectTarget>(make()); },
      std::move(profile)};
}
Player machine() {
  return player([] { return std::make_unique<runner::Machine>(); });
}

// The machine and its lawful variants.
const std::vector<Player>& references() {
  static const std::vector<Player> all = [] {
    std::vector<Player> out = {machine()};
    for (const mutants::LawfulVariant& one : mutants::lawful_variants()) {
      out.push_back(player(mutants::wrapped(one.step)));
    }
    return out;
  }();
  return all;
}

const std::vector<trace::Parsed>& golden() {
  static const std::vector<trace::Parsed> files = runner::load_cases("conformance/cases");
  return files;
}
std::vector<const trace::File*> golden_files() {
  std::vector<const trace::File*> out;
  for (const trace::Parsed& one : golden()) out.push_back(&one.file);
  return out;
}

// The first golden case that fails on this player.
struct Found {
  const trace::File* file = nullptr;
  const trace::Case* one = nullptr;
  runner::CaseResult result;
};
Found first_failing(const Player& broken) {
  for (const trace::File* file : golden_files()) {
    for (const trace::Case& one : file->cases) {
      runner::CaseResult result = runner::run_case(*file, one, broken.make);
      if (result.verdict == CaseVerdict::kFail) return {file, &one, std::move(result)};
    }
  }
  return {};
}

TEST(Shrink, KeepsWhatItIsAskedFor) {
  const trace::Parsed parsed = trace::parse(
      "%rtr 1\n%profile paper\n%node m5 mote id=5 iut\n%node m6 mote id=6\ncase x\n; why\n"
      "a: 0 m5 < app get_clock()\n  5 m5 < app start_all()\nb: a+9 m5 < app join(telosb_demo 3 1)\n"
      "  b+700 m5 < app get_clock()\n  a+0..9 m5 !> app clock(*)\n",
      "x.rtr");
  ASSERT_EQ(parsed.errors(), "");
  const Shrunk out = shrink(parsed.file, parsed.file.cases[0], [](const trace::File& file) {
    const auto lines = file.cases.at(0).lines();
    return std::any_of(lines.begin(), lines.end(),
                       [](const trace::Line* line) { return line->message.name == "join"; });
  });
  EXPECT_EQ(out.lines_before, 5u);
  EXPECT_EQ(out.lines, 1u);
  EXPECT_EQ(trace::print(*out.file.cases[0].lines()[0]),
            "      0          m5  <  app  join(telosb_demo 3 1)");
  EXPECT_EQ(out.file.cases[0].name, "x");
  EXPECT_TRUE(trace::check(out.file).empty());
}

TEST(Shrink, ATraceThatDoesNotFailIsUnchanged) {
  const trace::Parsed& file = golden().front();
  const Shrunk out =
      shrink(file.file, file.file.cases[0], [](const trace::File&) { return false; });
  EXPECT_EQ(out.lines_before, 0u);
  EXPECT_EQ(out.lines, file.file.cases[0].lines().size());
}

mutants::Mutants join_mutants() {
  mutants::Mutants out;
  mutants::mote_join_mutants(out);
  return out;
}

// For every named mutant of the join, its first failing case shrinks to one that still fails alike.
// The machine and its lawful variants pass that one, and no line of it can be dropped.
TEST(Shrink, FailuresOfMutants) {
  std::size_t before = 0;
  std::size_t after = 0;
  std::size_t count = 0;
  for (const mutants::Mutant& one : join_mutants()) {
    const Player broken = player(one.factory());
    const Found found = first_failing(broken);
    if (!found.one) continue;
    const StillShows shows = fails_alike(found.result, broken, references());
    const Shrunk out = shrink(*found.file, *found.one, shows);
    ASSERT_GT(out.lines_before, 0u) << one.name;
    EXPECT_TRUE(shows(out.file)) << one.name;
    EXPECT_LE(out.lines, out.lines_before);
    EXPECT_EQ(play(out.file, machine()).verdict, CaseVerdict::kPass) << one.name;
    const trace::Parsed again = trace::parse(trace::print(out.file), "shrunk.rtr");
    EXPECT_EQ(again.errors(), "") << one.name;
    const runner::CaseResult printed = play(again.file, broken);
    ASSERT_FALSE(printed.failures.empty()) << one.name << '\n' << trace::print(out.file);
    EXPECT_EQ(printed.failures[0].requirements, found.result.failures[0].requirements) << one.name;
    for (const Player& reference : references()) {
      EXPECT_LE(play(again.file, reference).verdict, CaseVerdict::kWeak) << one.name;
    }
    const auto& items = out.file.cases[0].items;
    for (std::size_t i = 0; i < items.size() && items.size() > 1; ++i) {
      trace::File less = out.file;
      less.cases[0].items.erase(less.cases[0].items.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_FALSE(trace::check(less).empty() && shows(less)) << one.name << " line " << i;
    }
    before += out.lines_before;
    after += out.lines;
    ++count;
  }
  EXPECT_GE(count, 20u);
  std::printf("%zu failing traces: %zu lines shrank to %zu\n", count, before, after);
  EXPECT_LT(after * 3, before * 2);
}

// Where a shorter trace could ask for more than the rules do: with two sinks, or with a full
// buffer, what is left still holds the reference machine and all its lawful variants harmless.
TEST(Shrink, DoesNotDriftIntoWhatDecisionsAllow) {
  for (const char* const name : {"two_sinks", "n2.mote_incoming_full", "n2.sink_incoming_full"}) {
    const trace::File* file = nullptr;
    const trace::Case* one = nullptr;
    for (const trace::File* each : golden_files()) {
      for (const trace::Case& at : each->cases) {
        if (at.name == name) file = each, one = &at;
      }
    }
    ASSERT_NE(one, nullptr) << name;
    std::size_t shrunk = 0;
    for (const mutants::Mutant& mutant : mutants::named_mutants()) {
      const Player broken = player(mutant.factory());
      const runner::CaseResult result = runner::run_case(*file, *one, broken.make);
      if (result.verdict != CaseVerdict::kFail) continue;
      const Shrunk out = shrink(*file, *one, fails_alike(result, broken, references()));
      ASSERT_GT(out.lines_before, 0u) << mutant.name;
      const runner::CaseResult again = play(out.file, broken);
      ASSERT_FALSE(again.failures.empty()) << mutant.name;
      EXPECT_EQ(again.failures[0].requirements, result.failures[0].requirements) << mutant.name;
      for (const Player& reference : references()) {
        EXPECT_LE(play(out.file, reference).verdict, CaseVerdict::kWeak) << mutant.name << '\n'
                                                                         << trace::print(out.file);
      }
      if (++shrunk == 2) break;
    }
    EXPECT_GT(shrunk, 0u) << name;
  }
}

TEST(Difference, OfAMutant) {
  const mutants::Mutant broken = join_mutants().front();
  const DifferenceSearch search =
      find_difference(golden_files(), machine(), player(broken.factory()));
  ASSERT_TRUE(search.shortest) << broken.name;
  EXPECT_FALSE(search.different.empty());
  EXPECT_EQ(search.shortest->a.verdict, CaseVerdict::kPass);
  EXPECT_EQ(search.shortest->b.verdict, CaseVerdict::kFail);
  EXPECT_LE(search.shortest->shrunk.lines, 6u);
}

TEST(Difference, OfTheProfiles) {
  Player deployed = machine();
  deployed.profile = "deployed";
  const DifferenceSearch search = find_difference(golden_files(), machine(), deployed);
  ASSERT_TRUE(search.shortest);
  EXPECT_EQ(search.shortest->b.verdict, CaseVerdict::kFail);
}

TEST(Difference, NoneOfAMachineToItself) {
  const DifferenceSearch search = find_difference(golden_files(), machine(), machine());
  EXPECT_FALSE(search.shortest);
  EXPECT_EQ(search.different, std::vector<std::string>{});
  EXPECT_GT(search.compared, 200u);
}

}  // namespace
}  // namespace rubric::shrink
