// Known failures: each way in which an entry holds, and each in which it does not.
#include "conformance/test/suite/expected.h"

#include <gmock/gmock.h>

#include "conformance/test/suite/tests/testing.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;
using ::testing::HasSubstr;

constexpr const char* kEntry =
    "- case: j4.accept\n  requirement: J4-ACK\n  message: nothing there\n  reason: Known.\n";

runner::Failure failure(std::vector<std::string> rules, const char* text, bool weak = false,
                        bool forbidden = false) {
  return {.requirements = std::move(rules), .weak = weak, .text = text, .forbidden = forbidden};
}

CaseRun failed(std::vector<runner::Failure> failures) {
  CaseRun one{.name = "j4.accept", .file = "conformance/cases/j4.rtr", .profile = "paper"};
  one.result.verdict = failures.empty() ? CaseVerdict::kPass : CaseVerdict::kFail;
  one.result.failures = std::move(failures);
  return one;
}
const runner::Failure kAck = failure({"J4-ACK"}, "it emitted nothing there");

struct Outcome {
  Expectation expectation;
  bool unexpected;
  std::vector<StaleExpectation> untrue;
  int exit_code;
};

Outcome hold(const std::string& yaml, CaseRun one, const char* target = "./node") {
  static const Cases all = Cases::own();
  const report::KnownFailures expected = parse_expected(yaml, "known.yaml");
  SuiteRun run;
  ImplementationRun& implementation = run.implementations.emplace_back();
  implementation.target = target;
  implementation.identity.name = "node";
  expect(expected, implementation, one);
  implementation.cases.push_back(one);
  run.stale = stale_expectations(expected, run, all);
  return {one.expectation, one.unexpected(), run.stale, exit_code(run)};
}

TEST(Expected, FailsAsTheEntrySays) {
  const Outcome out = hold(kEntry, failed({kAck}));
  EXPECT_EQ(out.expectation, Expectation::kAsExpected);
  EXPECT_FALSE(out.unexpected);
  EXPECT_TRUE(out.untrue.empty());
  EXPECT_EQ(out.exit_code, 0);
}

TEST(Expected, FailsWithoutAnEntry) {
  const Outcome out = hold("[]", failed({kAck}));
  EXPECT_EQ(out.expectation, Expectation::kNone);
  EXPECT_EQ(out.exit_code, 1);
}

TEST(Expected, PassesUnexpectedly) {
  const Outcome out = hold(kEntry, failed({}));
  EXPECT_EQ(out.expectation, Expectation::kUnexpectedPass);
  EXPECT_EQ(out.exit_code, 1);
  ASSERT_EQ(out.untrue.size(), 1U);
  EXPECT_EQ(out.untrue[0].place, "known.yaml:1");
  EXPECT_THAT(out.untrue[0].text, HasSubstr("j4.accept was expected to break J4-ACK with \"nothing "
                                            "there\", but passes"));
}

TEST(Expected, FailsWithAnotherMessage) {
  const Outcome out = hold(kEntry, failed({failure({"J4-ACK"}, "it came at 7, not from 0 to 5")}));
  EXPECT_EQ(out.expectation, Expectation::kOtherwise);
  EXPECT_EQ(out.exit_code, 1);
  ASSERT_EQ(out.untrue.size(), 1U);
  EXPECT_THAT(out.untrue[0].text, HasSubstr("it came at 7, not from 0 to 5"));
}

TEST(Expected, BreaksAnotherRule) {
  const Outcome out = hold(kEntry, failed({failure({"J4-SEQ"}, "it emitted nothing there")}));
  EXPECT_EQ(out.expectation, Expectation::kOtherwise);
  EXPECT_EQ(out.untrue.size(), 1U);
}

TEST(Expected, BreaksOneRuleMore) {
  const Outcome out = hold(kEntry, failed({kAck, failure({"J5-SUCCESS"}, "it emitted x")}));
  EXPECT_EQ(out.expectation, Expectation::kOtherwise);
  EXPECT_TRUE(out.unexpected);
  EXPECT_TRUE(out.untrue.empty()) << "what the entry says is true, but not all";
  EXPECT_EQ(out.exit_code, 1);
  EXPECT_EQ(hold(kEntry, failed({kAck, failure({"J1-SEQ"}, "weak", true)})).exit_code, 0);
}

TEST(Expected, FamiliesGlobsAndLinesWithoutRule) {
  const auto entry = [](const char* cases, const char* rule) {
    return std::string("- case: ") + cases + "\n  requirement: " + rule +
           "\n  message: nothing\n  reason: Known.\n";
  };
  EXPECT_EQ(hold(entry("'j4.*'", "J4"), failed({kAck})).exit_code, 0);
  EXPECT_EQ(hold(entry("[j4.accept]", "J4"), failed({kAck})).exit_code, 0);
  EXPECT_EQ(hold(entry("[j4.gone, j4.accept]", "J4"), failed({kAck})).untrue.size(), 1U);
  EXPECT_EQ(hold(entry("j4.accept", "none"), failed({kAck})).exit_code, 1);
  EXPECT_EQ(hold(entry("j4.accept", "none"), failed({failure({}, "nothing")})).exit_code, 0);
}

TEST(Expected, AnUntrueEntryIsReportedOnce) {
  static const Cases cases = Cases::own();
  const report::KnownFailures file = parse_expected(
      "- {case: 'j*', requirement: J4, message: nothing, reason: Known.}\n", "known.yaml");
  SuiteRun run;
  ImplementationRun& node = run.implementations.emplace_back();
  for (const SuiteCase& one : cases.all()) {
    if (one.one->name.starts_with("j")) node.cases.push_back(one.blank());
  }
  const std::size_t all = node.cases.size();
  ASSERT_GT(all, 7U);
  node.cases[1].result.verdict = CaseVerdict::kFail;
  node.cases[1].result.failures = {kAck};
  const std::vector<StaleExpectation> stale = stale_expectations(file, run, cases);
  ASSERT_EQ(stale.size(), 1U);
  EXPECT_EQ(stale[0].place, "known.yaml:1");
  const std::string& text = stale[0].text;
  EXPECT_THAT(text, HasSubstr(std::to_string(all - 1) + " of the " + std::to_string(all) +
                              " runs that 'j*' names do not fail so (" + node.cases[0].name + ", " +
                              node.cases[2].name + ", "));
  EXPECT_THAT(text, HasSubstr(", ...). The first: " + node.cases[0].name + " was expected"));
  for (CaseRun& one : node.cases) {
    one.result.verdict = CaseVerdict::kFail;
    one.result.failures = {kAck};
  }
  EXPECT_TRUE(stale_expectations(file, run, cases).empty());
}

TEST(Expected, AnEmptyFileExpectsNothing) {
  for (const char* text : {"", "# all mended\n"}) {
    EXPECT_EQ(hold(text, failed({})).exit_code, 0);
    EXPECT_EQ(hold(text, failed({kAck})).exit_code, 1);
  }
}

TEST(Expected, NamesNoCase) {
  const Outcome out = hold("- {case: j4.gone, requirement: J4, message: x, reason: y}", failed({}));
  EXPECT_EQ(out.exit_code, 1);
  ASSERT_EQ(out.untrue.size(), 1U);
  EXPECT_EQ(out.untrue[0].text, "no case is called 'j4.gone'");
}

TEST(Expected, OfAnotherTargetOrProfile) {
  const std::string other = std::string(kEntry) + "  target: ./other\n";
  EXPECT_EQ(hold(other, failed({})).exit_code, 0);
  EXPECT_EQ(hold(other, failed({kAck})).exit_code, 1);
  EXPECT_EQ(hold(std::string(kEntry) + "  target: './no*'\n", failed({kAck})).exit_code, 0);
  EXPECT_EQ(hold(std::string(kEntry) + "  target: node\n", failed({kAck}), "x y").exit_code, 0);
  EXPECT_EQ(hold(std::string(kEntry) + "  profile: deployed\n", failed({})).exit_code, 0);
}

TEST(Expected, UnfinishedCasesDecideNothing) {
  for (const CaseVerdict verdict : {CaseVerdict::kSkip, CaseVerdict::kInconclusive}) {
    CaseRun one = failed({});
    one.result.verdict = verdict;
    const Outcome out = hold(kEntry, one);
    EXPECT_EQ(out.expectation, Expectation::kNone);
    EXPECT_TRUE(out.untrue.empty());
    EXPECT_EQ(out.exit_code, 3);
  }
  CaseRun died = failed({kAck});
  died.result.failures[0].crash = true;
  EXPECT_EQ(hold(kEntry, died).exit_code, 0) << "a death can be expected";
  died.profile = "deployed";
  died.result.failures[0].requirements = {"T3-TIMEOUT"};
  EXPECT_EQ(hold("[]", died).exit_code, 1) << "no profile accepts a death";
  CaseRun broke = failed({kAck});
  broke.result.verdict = CaseVerdict::kError;
  EXPECT_EQ(hold(kEntry, broke).exit_code, 2) << "an error is never expected";
}

TEST(Expected, DifferencesThatTheProfileAccepts) {
  CaseRun one = failed({failure({"T4-SEVERAL", "T3-TIMEOUT"}, "it emitted nothing there")});
  EXPECT_EQ(hold("[]", one).exit_code, 1) << "the paper accepts none";
  one.profile = "deployed";
  EXPECT_EQ(hold("[]", one).expectation, Expectation::kAsExpected);
  one.result.failures[0].requirements = {"T4-SEVERAL"};
  EXPECT_EQ(hold("[]", one).exit_code, 1);
  one.result.failures = {failure({"J8-FAIL", "J8-LIMIT"}, "it emitted x", false, true)};
  EXPECT_EQ(hold("[]", one).exit_code, 1) << "each rule that forbids it counts";
}

// Runs one case that passes and one that is owed.
Outcome hold_owed(const std::string& yaml, bool owed = true) {
  static const Cases all = Cases::own();
  const report::KnownFailures expected = parse_expected(yaml, "known.yaml");
  SuiteRun run;
  ImplementationRun& implementation = run.implementations.emplace_back();
  implementation.cases = {failed({}), failed({})};
  CaseRun& one = implementation.cases[1];
  one.name = "j8.fail";
  if (owed) one.result.verdict = CaseVerdict::kSkip;
  one.owed = owed;
  expect(expected, implementation, one);
  run.stale = stale_expectations(expected, run, all);
  return {one.expectation, one.unexpected(), run.stale, exit_code(run)};
}

TEST(Expected, WhatIsNotDecidedIsOwedUnlessItIsListed) {
  EXPECT_EQ(hold_owed("[]").exit_code, 3);
  EXPECT_EQ(hold_owed("[]", false).exit_code, 0);
  for (const char* listed : {"j8.fail", "'j8.*'", "[j4.few, j8.fail]"}) {
    const std::string entry = std::string("- skip: ") + listed + "\n  reason: We cannot.\n";
    EXPECT_EQ(hold_owed(entry).exit_code, 0) << listed;
    EXPECT_FALSE(hold_owed(entry).unexpected);
    EXPECT_EQ(hold_owed(entry + "  target: ./other\n").exit_code, 3);
    const Outcome decided = hold_owed(entry, false);
    EXPECT_EQ(decided.exit_code, 1) << listed;
    EXPECT_EQ(decided.untrue.size(), 1U) << "j4.few was not chosen";
  }
  const auto listed = parse_expected("- {skip: [a.b, c.d], reason: x}", "k.yaml").entries;
  ASSERT_EQ(listed.size(), 2U);
  EXPECT_EQ(listed[0].cases + listed[1].cases + listed[0].reason + listed[1].reason, "a.bc.dxx");
  EXPECT_EQ(hold_owed("- {skip: j4.accept, reason: x}").exit_code, 1) << "it was decided";
  EXPECT_EQ(hold_owed("- {skip: 'j*', reason: x}").exit_code, 0) << "one of them was not";
  EXPECT_EQ(hold_owed("- {skip: j8.gone, reason: x}").untrue.size(), 1U);
}

TEST(Expected, SomeRulesCanBeRequired) {
  SuiteRun run;
  ImplementationRun& implementation = run.implementations.emplace_back();
  implementation.cases = {failed({})};
  implementation.cases[0].requirements = {"J4-ACK"_rule};
  run.rules_required = 1;
  EXPECT_EQ(exit_code(run), 0);
  run.rules_required = 2;
  EXPECT_EQ(exit_code(run), 3);
  EXPECT_EQ(incomplete(run, implementation), "1 rule decided, of 2 required");
}

TEST(Expected, MessagesAreComparedByTheirWords) {
  using report::has_tokens;
  EXPECT_TRUE(has_tokens("c+0..2000 sA  !>  rA join_reply(*)", "sA !> rA join_reply( *"));
  EXPECT_TRUE(has_tokens("at 7 it emitted rA x", "it emitted"));
  EXPECT_TRUE(has_tokens("anything", ""));
  EXPECT_FALSE(has_tokens("it emitted rA join_reply(*)", "join"));
  EXPECT_FALSE(has_tokens("number 17", "number 1"));
  EXPECT_FALSE(has_tokens("a b c", "a c"));
}

TEST(ExpectedFile, SaysWhatIsWrongAndWhere) {
  const auto why = [](const std::string& text) -> std::string {
    try {
      parse_expected(text, "k.yaml");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why("case: x"), "k.yaml:1: expected a list of expected failures");
  EXPECT_EQ(why("- x"), "k.yaml:1: expected case, requirement, message and reason");
  EXPECT_EQ(why("- case: x\n  message: y\n  reason: z\n"), "k.yaml:1: requirement is missing");
  EXPECT_EQ(why("\n- case: x\n  case: y\n"), "k.yaml:3: case is given twice");
  EXPECT_EQ(why("- case: {x: y}\n"), "k.yaml:1: case: expected a text");
  EXPECT_EQ(why("- case: [x, [y]]\n"), "k.yaml:1: case: expected a text");
  EXPECT_THAT(why("- requirement: J44\n"), HasSubstr("k.yaml:1: no requirement is called 'J44'"));
  EXPECT_THAT(why("- profile: x\n"), HasSubstr("profile is paper or deployed"));
  EXPECT_THAT(why("- nodes: x\n"), HasSubstr("unknown key 'nodes'"));
  EXPECT_EQ(why("- requirement: J4\n  node: x\n"),
            "k.yaml:2: 'node' belongs to a list for rubric check; this one is for rubric test");
  EXPECT_EQ(why("- case: x\n  reason: ''\n"), "k.yaml:2: reason is empty: say why this is known");
  EXPECT_EQ(why("- case: x\n  reason:\n"), "k.yaml:2: reason is empty: say why this is known");
  EXPECT_EQ(why("- skip: []\n  reason: x\n"), "k.yaml:1: skip: expected a text");
  EXPECT_THAT(why("- {skip: x, requirement: J4, reason: y}\n"), HasSubstr("unknown key"));
  EXPECT_THAT(why("- {"), HasSubstr("k.yaml:1: "));
  EXPECT_THAT(why("- case: x\n  reason: z\n---\n- case: y\n"),  // Which would be passed over.
              HasSubstr("k.yaml:3: what is here belongs to nothing"));
}

}  // namespace
}  // namespace rubric::suite
