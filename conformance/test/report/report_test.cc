// Every kind of result, in each form of report that programs read.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "codec/reflect/fault_text.h"
#include "conformance/test/report/compare.h"
#include "conformance/test/report/github.h"
#include "conformance/test/report/json.h"
#include "conformance/test/report/junit.h"
#include "conformance/test/report/tap.h"
#include "conformance/test/report/text/text.h"
#include "conformance/test/report/words.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;
using Json = nlohmann::json;

CaseRun one(const std::string& name, CaseVerdict verdict) {
  CaseRun run;
  run.name = name;
  run.file = "conformance/cases/j4.rtr";
  run.roles = {machine::Role::kMote};
  run.requirements = {"J4-SEQ"_rule};
  run.wall_ms = 1.5;
  run.result.name = name;
  run.result.verdict = verdict;
  if (verdict == CaseVerdict::kSkip) run.result.reason = "no base station";
  if (verdict == CaseVerdict::kFail || verdict == CaseVerdict::kWeak) {
    run.result.failures.push_back({{12, 1},
                                   {"J4-SEQ"},
                                   verdict == CaseVerdict::kWeak,
                                   7,
                                   "m5 !> rA  ack_join(*)",
                                   "at 7 it emitted ack_join"});
  }
  if (verdict == CaseVerdict::kError) {
    run.result.reason = "it died";
    run.result.failures.push_back({{3, 1}, {}, false, 0, "", "it died"});
    run.stderr_text = "panic: <b>&\x01\xFF\n# second: 50%";
  }
  return run;
}

SuiteRun every_kind() {
  SuiteRun run;
  ImplementationRun& tiny = run.implementations.emplace_back();
  tiny.target = "./tiny it's";
  tiny.identity = {"tiny", "0.3", {machine::Role::kMote}, false};
  tiny.wall_ms = 12;
  tiny.cases = {one("a.pass", CaseVerdict::kPass),  one("a.weak", CaseVerdict::kWeak),
                one("a.fail", CaseVerdict::kFail),  one("a.error", CaseVerdict::kError),
                one("a.skip", CaseVerdict::kSkip),  one("a.known", CaseVerdict::kFail),
                one("a.better", CaseVerdict::kPass)};
  tiny.cases[5].expectation = Expectation::kAsExpected;
  tiny.cases[5].expected_reason = "issue #7";
  tiny.cases[6].expectation = Expectation::kUnexpectedPass;
  tiny.cases[6].expected_reason = "was broken";
  run.stale.push_back({"known.yaml:9", "no case is called z.z"});
  return run;
}

TEST(Report, TapHasAPointForEachCaseAndExpectation) {
  EXPECT_EQ(
      tap_report(every_kind()),
      "TAP version 13\n1..8\n"
      "ok 1 - tiny 0.3: a.pass\n"
      "ok 2 - tiny 0.3: a.weak\n"
      "  ---\n  verdict: weak\n  file: conformance/cases/j4.rtr\n  details: |\n"
      "    conformance/cases/j4.rtr:12: J4-SEQ (SHOULD)\n"
      "      J4-SEQ (MUST): " +
          std::string(reflect::requirement("J4-SEQ"_rule).sentence) +
          "\n      expected  m5 !> rA  ack_join(*)\n      but       at 7 it emitted ack_join\n"
          "  ...\n"
          "not ok 3 - tiny 0.3: a.fail\n"
          "  ---\n  verdict: fail\n  file: conformance/cases/j4.rtr\n  details: |\n"
          "    conformance/cases/j4.rtr:12: J4-SEQ\n"
          "      J4-SEQ (MUST): " +
          std::string(reflect::requirement("J4-SEQ"_rule).sentence) +
          "\n      expected  m5 !> rA  ack_join(*)\n      but       at 7 it emitted ack_join\n"
          "  ...\n"
          "not ok 4 - tiny 0.3: a.error\n"
          "  ---\n  verdict: error\n  file: conformance/cases/j4.rtr\n  details: |\n"
          "    conformance/cases/j4.rtr:3: it died\n"
          "    standard error:\n    panic: <b>&\\x01\\xff\n    # second: 50%\n"
          "  ...\n"
          "ok 5 - tiny 0.3: a.skip # SKIP skip: no base station\n"
          "not ok 6 - tiny 0.3: a.known # TODO issue \\#7\n"
          "  ---\n  verdict: fail\n  file: conformance/cases/j4.rtr\n  details: |\n"
          "    conformance/cases/j4.rtr:12: J4-SEQ\n"
          "      J4-SEQ (MUST): " +
          std::string(reflect::requirement("J4-SEQ"_rule).sentence) +
          "\n      expected  m5 !> rA  ack_join(*)\n      but       at 7 it emitted ack_join\n"
          "  ...\n"
          "not ok 7 - tiny 0.3: a.better\n"
          "  ---\n  verdict: pass\n  file: conformance/cases/j4.rtr\n  details: |\n"
          "    expected to fail: was broken\n"
          "  ...\n"
          "not ok 8 - known.yaml:9: no case is called z.z\n");
}

TEST(Report, AnnotationsAreTheGravestFirstAndEscaped) {
  EXPECT_EQ(github_annotations(every_kind(), 3),
            "::error file=known.yaml,line=9,title=expectation that is not true::no case is called "
            "z.z\n"
            "::error file=conformance/cases/j4.rtr,line=3,title=a.error on tiny 0.3::it died\n"
            "::error file=conformance/cases/j4.rtr,line=12,title=a.fail on tiny 0.3::J4-SEQ: at 7 "
            "it emitted ack_join\n");
  SuiteRun run = every_kind();
  run.implementations[0].identity.name = "a,b:c";
  run.implementations[0].cases = {one("x", CaseVerdict::kFail)};
  run.implementations[0].cases[0].result.failures[0].text = "50%\nof it";
  run.stale.clear();
  EXPECT_EQ(github_annotations(run),
            "::error file=conformance/cases/j4.rtr,line=12,title=x on a%2Cb%3Ac 0.3::J4-SEQ: 50%25"
            "%0Aof it\n");
}

TEST(Report, ARefusedImplementationIsNotASuccess) {
  SuiteRun run = every_kind();
  run.stale.clear();
  run.implementations[0].cases.clear();
  run.implementations[0].dishonest = "it passes everything";
  EXPECT_EQ(tap_report(run),
            "TAP version 13\n1..1\nnot ok 1 - tiny 0.3: refused: it passes everything\n");
  EXPECT_EQ(github_annotations(run), "::error title=tiny 0.3 is refused::it passes everything\n");
  EXPECT_NE(junit_report(run).find("<error type=\"error\" message=\"it passes everything\"/>"),
            std::string::npos);
}

TEST(Report, WhatHappensOutsideOfCasesIsShown) {
  SuiteRun run = every_kind();
  run.stale.clear();
  ImplementationRun& tiny = run.implementations[0];
  tiny.cases = {one("a.pass", CaseVerdict::kPass)};
  tiny.outside = {{"after `bye`", "ended with status 3", false, "boo <1>\n"}};
  EXPECT_EQ(tap_report(run),
            "TAP version 13\n1..1\nok 1 - tiny 0.3: a.pass\n"
            "# tiny 0.3: ended with status 3, after `bye`\n");
  EXPECT_EQ(github_annotations(run), "");
  std::string xml = junit_report(run);
  EXPECT_NE(xml.find("tests=\"2\" failures=\"0\" errors=\"0\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("name=\"outside_of_cases\" time=\"0\">\n<system-out>ended with status 3, "
                     "after `bye`\nboo &lt;1&gt;\n</system-out>"),
            std::string::npos)
      << xml;

  tiny.outside.push_back({"before a.pass", "wrote 'x'", true, ""});
  EXPECT_EQ(tap_report(run),
            "TAP version 13\n1..2\nok 1 - tiny 0.3: a.pass\n"
            "not ok 2 - tiny 0.3: outside of cases: wrote 'x', before a.pass "
            "(and 1 more)\n");
  EXPECT_EQ(github_annotations(run),
            "::error title=tiny 0.3 broke between cases::wrote 'x', before a.pass (and 1 more)\n");
  xml = junit_report(run);
  EXPECT_NE(xml.find("tests=\"2\" failures=\"0\" errors=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("<error type=\"error\" message=\"wrote 'x', before a.pass"), std::string::npos)
      << xml;
  const Json report = Json::parse(json_report(run));
  EXPECT_EQ(report["exit_code"], 2);
  EXPECT_EQ(report["implementations"][0]["outside"],
            Json::parse(R"([{"when": "after `bye`", "text": "ended with status 3", "broke": false,
                             "stderr": "boo <1>\n"},
                            {"when": "before a.pass", "text": "wrote 'x'", "broke": true,
                             "stderr": ""}])"));
}

TEST(Report, ARunThatIsIncompleteAsAWholeIsNotASuccess) {
  SuiteRun run = every_kind();
  run.stale.clear();
  run.implementations[0].cases = {one("a.skip", CaseVerdict::kSkip)};
  EXPECT_EQ(exit_code(run), 3);
  EXPECT_EQ(tap_report(run),
            "TAP version 13\n1..2\nok 1 - tiny 0.3: a.skip # SKIP skip: no base station\n"
            "not ok 2 - tiny 0.3: incomplete: nothing was decided\n");
  EXPECT_EQ(github_annotations(run), "::error title=tiny 0.3 is incomplete::nothing was decided\n");
  const std::string xml = junit_report(run);
  EXPECT_NE(xml.find("tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"1\""), std::string::npos)
      << xml;
  EXPECT_NE(xml.find("<failure type=\"incomplete\" message=\"nothing was decided\"/>"),
            std::string::npos)
      << xml;

  run.implementations[0].cases = {one("a.skip", CaseVerdict::kSkip)};
  run.implementations[0].cases[0].owed = true;  // Its own point says so.
  EXPECT_EQ(tap_report(run).find("incomplete"), std::string::npos);
  EXPECT_EQ(junit_report(run).find("nothing was decided"), std::string::npos);
}

// A rule that was not seen kept or broken is open, unless a case that names it decides it.
TEST(Report, ARuleThatIsLeftOpenIsNotASuccess) {
  SuiteRun run = every_kind();
  run.stale.clear();
  std::vector<CaseRun>& cases = run.implementations[0].cases;
  cases = {one("a.pass", CaseVerdict::kPass)};
  run.implementations[0].outside = {
      {"from its first case to its last", "said nothing", false, "", "N9-SET"_rule}};
  EXPECT_EQ(exit_code(run), 3);
  EXPECT_EQ(
      incomplete_as_a_whole(run, run.implementations[0]),
      "N9-SET is not decided, for it said nothing, from its first case to its last; --app lets "
      "cases decide it");
  cases[0].requirements.emplace_back("N9-SET"_rule);
  EXPECT_EQ(exit_code(run), 0);
  cases[0].result.verdict = CaseVerdict::kInconclusive;
  cases.push_back(one("a.other", CaseVerdict::kPass));
  EXPECT_EQ(exit_code(run), 3);
}

TEST(Report, WhatAnInconclusiveCaseBreaksIsShown) {
  SuiteRun run = every_kind();
  run.stale.clear();
  CaseRun half = one("a.half", CaseVerdict::kWeak);
  half.result.verdict = CaseVerdict::kInconclusive;
  half.result.unseen = {"peis"};
  run.implementations[0].cases = {one("a.pass", CaseVerdict::kPass), half};
  EXPECT_NE(tap_report(run).find("J4-SEQ (SHOULD)"), std::string::npos);
  EXPECT_NE(junit_report(run).find("J4-SEQ (SHOULD)"), std::string::npos);
  const TextOptions options;
  EXPECT_EQ(case_text(run.implementations[0].cases[1], options).substr(0, 20),
            "inconclusive a.half ");
  EXPECT_NE(story_text(run, run.implementations[0], options).find("INCONCLUSIVE a.half: J4-SEQ"),
            std::string::npos);
}

TEST(Report, ChannelAccessIsAdvisedOnce) {
  SuiteRun run = every_kind();
  std::vector<CaseRun>& cases = run.implementations[0].cases;
  const auto advised = [&] {
    return Json::parse(json_report(run))["implementations"][0]["advice"];
  };
  EXPECT_EQ(advised(), Json::array());
  cases[2].channel_access = 30;
  cases[5].channel_access = 30;
  const std::string text =
      "2 failed cases would pass with --state channel_access=30: state it if the radio waits for a "
      "free channel before it sends (decision 128).";
  EXPECT_EQ(advised(), Json::array({text}));
  TextOptions how;
  how.width = 500;
  const std::string totals = totals_text(run, run.implementations[0], how);
  EXPECT_NE(totals.find("\n  " + text + "\n"), std::string::npos) << totals;
}

TEST(Report, AtMostTenAnnotations) {
  SuiteRun run = every_kind();
  run.implementations[0].cases.assign(25, one("x", CaseVerdict::kFail));
  const std::string text = github_annotations(run);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
}

TEST(Report, JunitCountsAndEscapes) {
  const std::string xml = junit_report(every_kind());
  EXPECT_NE(xml.find("<testsuite name=\"rubric test: tiny 0.3\" tests=\"7\" failures=\"2\" "
                     "errors=\"1\" skipped=\"2\" time=\"0.012\">"),
            std::string::npos)
      << xml;
  EXPECT_NE(xml.find("panic: &lt;b&gt;&amp;\xEF\xBF\xBD\xEF\xBF\xBD"), std::string::npos) << xml;
  EXPECT_NE(xml.find("<skipped message=\"known: issue #7\"/>"), std::string::npos);
  EXPECT_NE(xml.find("<failure type=\"unexpected_pass\""), std::string::npos);
  EXPECT_NE(xml.find("<failure type=\"stale\" message=\"no case is called z.z\"/>"),
            std::string::npos);
}

TEST(Report, NamesAreUniqueWhereACaseOrAnImplementationIsRepeated) {
  SuiteRun run = every_kind();
  run.implementations[0].cases = {one("x", CaseVerdict::kPass), one("x", CaseVerdict::kPass)};
  run.implementations[0].cases[1].repeat = 1;
  run.implementations.push_back(run.implementations[0]);
  run.stale.clear();
  const std::string xml = junit_report(run);
  for (const char* name : {"classname=\"rubric.tiny 0_3 #1\" name=\"x\"",
                           "classname=\"rubric.tiny 0_3 #1\" name=\"x#2\"",
                           "classname=\"rubric.tiny 0_3 #2\" name=\"x\"",
                           "classname=\"rubric.tiny 0_3 #2\" name=\"x#2\""}) {
    const std::size_t at = xml.find(name);
    ASSERT_NE(at, std::string::npos) << name << '\n' << xml;
    EXPECT_EQ(xml.find(name, at + 1), std::string::npos);
  }
}

TEST(Report, JsonHasEverythingAndIsReadAgain) {
  const SuiteRun run = every_kind();
  const std::string text = json_report(run);
  const Json all = Json::parse(text);
  EXPECT_EQ(all["schema"], "rubric.test/1");
  EXPECT_EQ(all["exit_code"], 2);
  const Json& tiny = all["implementations"][0];
  EXPECT_EQ(tiny["counts"]["fail"], 2);
  EXPECT_EQ(tiny["counts"]["inconclusive"], 0);
  EXPECT_EQ(tiny["cases"][2]["failures"][0]["requirements"][0], "J4-SEQ");
  EXPECT_EQ(tiny["cases"][2]["failures"][0]["line"], 12);
  EXPECT_EQ(tiny["cases"][2]["unexpected"], true);
  EXPECT_EQ(tiny["cases"][5]["unexpected"], false);
  EXPECT_EQ(all["stale"][0]["place"], "known.yaml:9");
  const EarlierRun earlier = read_json_report(text);
  EXPECT_EQ(earlier.verdicts.size(), 7u);
  EXPECT_EQ(earlier.verdicts.at({"tiny", "a.weak"}), "weak");
}

TEST(Report, JUnitHasTheTotalsOfAllSuites) {
  SuiteRun run = every_kind();
  run.implementations.push_back(run.implementations[0]);
  run.implementations[1].cases.resize(1);
  const std::string xml = junit_report(run);
  EXPECT_NE(xml.find("<testsuites name=\"rubric test\" tests=\"9\" failures=\"3\" errors=\"1\" "
                     "skipped=\"2\" time=\"0.024\">"),
            std::string::npos)
      << xml;
}

TEST(Report, HeadlinesSayWhatShouldHaveBeen) {
  CaseRun run = one("a", CaseVerdict::kFail);
  runner::Failure& failure = run.result.failures[0];
  failure.forbidden = true;
  EXPECT_EQ(headline(run), "J4-SEQ: forbidden, but at 7 it emitted ack_join");
  failure.forbidden = false;
  failure.expected = "a+2000..4300 m5 > app  joined(result=fail ...)  [J8-FAIL]";
  failure.requirements = {"J8-FAIL"};
  failure.text = "it emitted nothing there";
  EXPECT_EQ(headline(run),
            "J8-FAIL: expected m5 > app joined(result=fail ...), but it emitted "
            "nothing there");
}

TEST(Report, HeadlinesOfErrorsBeginWithWhatBroke) {
  CaseRun run = one("a", CaseVerdict::kError);
  EXPECT_EQ(headline(run), "it died");
  run.result.reason = "`call 0 join(type=1)`: ended with status 134";
  EXPECT_EQ(what_broke(run), "ended with status 134");
  EXPECT_EQ(headline(run), "ended with status 134, at `call 0 join(type=1)`");
}

TEST(Report, ALineWithoutRuleSaysSoAndWhatBrokeSaysHow) {
  CaseRun run = one("a", CaseVerdict::kFail);
  run.result.failures[0].requirements.clear();
  EXPECT_EQ(headline(run), "at 7 it emitted ack_join");
  EXPECT_EQ(in_full(run),
            "conformance/cases/j4.rtr:12: a line that names no rule\n"
            "  expected  m5 !> rA  ack_join(*)\n"
            "  but       at 7 it emitted ack_join\n");
}

std::string text_of(const std::vector<Change>& changes) {
  std::string out;
  for (const Change& one : changes) {
    out += one.implementation + " " + one.case_name + ": " + one.was + "-" + one.is + "\n";
  }
  return out;
}

TEST(Compare, ChangedNewAndGone) {
  SuiteRun before = every_kind();
  ImplementationRun& tiny = before.implementations[0];
  tiny.identity.version = "0.2";  // Versions are what is compared.
  tiny.cases = {one("a.gone", CaseVerdict::kPass), one("a.fail", CaseVerdict::kPass),
                one("a.twice", CaseVerdict::kPass), one("a.twice", CaseVerdict::kFail)};
  tiny.cases[3].repeat = 1;
  before.implementations.push_back(tiny);  // Same name, with cases of its own.
  before.implementations[1].cases = {one("a.fail", CaseVerdict::kFail)};
  before.implementations.push_back(before.implementations[1]);
  before.implementations[2].identity.name = "other";

  SuiteRun now = every_kind();
  now.implementations[0].cases = {one("a.fail", CaseVerdict::kFail),
                                  one("a.twice", CaseVerdict::kPass),
                                  one("a.new", CaseVerdict::kSkip)};
  now.implementations.push_back(now.implementations[0]);
  now.implementations[1].cases = {one("a.fail", CaseVerdict::kPass)};
  const Comparison since = compare(now, read_json_report(json_report(before)));
  EXPECT_EQ(text_of(since.changed),
            "tiny 0.3 #1 a.fail: pass-fail\n"
            "tiny 0.3 #2 a.fail: fail-pass\n");
  EXPECT_EQ(text_of(since.added), "tiny 0.3 #1 a.new: -skip\n");
  EXPECT_EQ(text_of(since.gone),
            "other a.fail: fail-\n"
            "tiny 0.3 #1 a.gone: pass-\n"
            "tiny 0.3 #1 a.twice#2: fail-\n");
}

struct BadJson {
  const char* text;
  const char* error;
};
TEST(Report, WhatIsNoReportIsRefusedWithItsPlace) {
  const BadJson rows[] = {
      {"", "byte 1: this is not JSON"},
      {"{\"schema\": ", "byte 12: this is not JSON"},
      {"[]", "the report: there is no \"schema\""},
      {"{\"schema\":\"rubric.check/1\"}", "schema is \"rubric.check/1\"; this reads rubric.test/1"},
      {"{\"schema\":\"rubric.test/1\"}", "the report: there is no \"implementations\""},
      {"{\"schema\":\"rubric.test/1\",\"implementations\":{}}",
       "the report: implementations is not a list"},
      {"{\"schema\":\"rubric.test/1\",\"implementations\":[{\"name\":1}]}",
       "implementations[0]: name is not text"},
      {"{\"schema\":\"rubric.test/1\",\"implementations\":[{\"name\":\"a\",\"cases\":[{}]}]}",
       "implementations[0].cases[0]: there is no \"name\""},
  };
  for (const BadJson& row : rows) {
    try {
      read_json_report(row.text);
      ADD_FAILURE() << row.text;
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), row.error) << row.text;
    }
  }
}

TEST(Report, ReplayCommandsAreQuotedForAShell) {
  SuiteRun run = every_kind();
  run.profile = "deployed";
  run.stated = {{trace::ParameterId::kAckTimeout, 2000}, {trace::ParameterId::kResponse, 350}};
  run.traces = {"my cases"};
  run.implementations[0].cases[0].seed = 9;
  EXPECT_EQ(replay_command(run, run.implementations[0], run.implementations[0].cases[0]),
            "rubric test --target './tiny it'\\''s' --cases a.pass --state ack_timeout=2000 "
            "--state response=350 --profile deployed --seed 9 'my cases'");
}

}  // namespace
}  // namespace rubric::suite
