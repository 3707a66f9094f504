// Every kind of result, in each form of report that programs read.
#include <gtest/gtest.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "codec/reflect/fault_text.h"
#include "conformance/suite/report/github.h"
#include "conformance/suite/report/json.h"
#include "conformance/suite/report/junit.h"
#include "conformance/suite/report/tap.h"
#include "conformance/suite/report/words.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;
using Json = nlohmann::json;

CaseRun one(const std::string& name, CaseVerdict verdict) {
  CaseRun run;
  run.name = name;
  run.file = "conformance/cases/j4.rtr";
  run.roles = {machine::Role::kMote};
  run.requirements = {req::kJ4Seq};
  run.wall_ms = 1.5;
  run.result.name = name;
  run.result.verdict = verdict;
  if (verdict == CaseVerdict::kSkip) run.result.reason = "no base station";
  if (verdict == CaseVerdict::kFail || verdict == CaseVerdict::kWeak) {
    run.result.failures.push_back({{12, 1}, {"J4-SEQ"}, verdict == CaseVerdict::kWeak, 7,
                                   "m5 !> rA  ack_join(*)", "at 7 it emitted ack_join"});
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
  tiny.cases = {one("a.pass", CaseVerdict::kPass), one("a.weak", CaseVerdict::kWeak),
                one("a.fail", CaseVerdict::kFail), one("a.error", CaseVerdict::kError),
                one("a.skip", CaseVerdict::kSkip), one("a.known", CaseVerdict::kFail),
                one("a.better", CaseVerdict::kPass)};
  tiny.cases[5].expectation = Expectation::kAsExpected;
  tiny.cases[5].expected_reason = "issue #7";
  tiny.cases[6].expectation = Expectation::kUnexpectedPass;
  tiny.cases[6].expected_reason = "was broken";
  run.stale.push_back({"known.yaml:9", "no case is called z.z"});
  return run;
}

TEST(Report, TapHasAPointForEachCaseAndExpectation) {
  EXPECT_EQ(tap_report(every_kind()),
            "TAP version 13\n1..8\n"
            "ok 1 - tiny 0.3: a.pass\n"
            "ok 2 - tiny 0.3: a.weak\n"
            "  ---\n  verdict: weak\n  file: conformance/cases/j4.rtr\n  details: |\n"
            "    conformance/cases/j4.rtr:12: J4-SEQ (SHOULD)\n"
            "      J4-SEQ (MUST): " + std::string(reflect::requirement(req::kJ4Seq).sentence) +
            "\n      expected  m5 !> rA  ack_join(*)\n      but       at 7 it emitted ack_join\n"
            "  ...\n"
            "not ok 3 - tiny 0.3: a.fail\n"
            "  ---\n  verdict: fail\n  file: conformance/cases/j4.rtr\n  details: |\n"
            "    conformance/cases/j4.rtr:12: J4-SEQ\n"
            "      J4-SEQ (MUST): " + std::string(reflect::requirement(req::kJ4Seq).sentence) +
            "\n      expected  m5 !> rA  ack_join(*)\n      but       at 7 it emitted ack_join\n"
            "  ...\n"
            "not ok 4 - tiny 0.3: a.error\n"
            "  ---\n  verdict: error\n  file: conformance/cases/j4.rtr\n  details: |\n"
            "    conformance/cases/j4.rtr:3: no rule\n      but       it died\n"
            "    standard error:\n    panic: <b>&\\x01\\xff\n    # second: 50%\n"
            "  ...\n"
            "ok 5 - tiny 0.3: a.skip # SKIP skip: no base station\n"
            "not ok 6 - tiny 0.3: a.known # TODO issue \\#7\n"
            "  ---\n  verdict: fail\n  file: conformance/cases/j4.rtr\n  details: |\n"
            "    conformance/cases/j4.rtr:12: J4-SEQ\n"
            "      J4-SEQ (MUST): " + std::string(reflect::requirement(req::kJ4Seq).sentence) +
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
            "::error file=conformance/cases/j4.rtr,line=3,title=a.error on tiny 0.3::no rule: it "
            "died\n"
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

TEST(Report, ARefusedImplementationIsNoSuccess) {
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
            std::string::npos) << xml;
  EXPECT_NE(xml.find("panic: &lt;b&gt;&amp;\xEF\xBF\xBD\xEF\xBF\xBD"), std::string::npos) << xml;
  EXPECT_NE(xml.find("<skipped message=\"known: issue #7\"/>"), std::string::npos);
  EXPECT_NE(xml.find("<failure type=\"unexpected_pass\""), std::string::npos);
  EXPECT_NE(xml.find("<failure type=\"stale\" message=\"no case is called z.z\"/>"),
            std::string::npos);
}

TEST(Report, NamesAreUniqueWhereACaseIsRepeatedOrAnImplementationStandsTwice) {
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

struct BadJson {
  const char* text;
  const char* error;
};
TEST(Report, WhatIsNoReportIsRefusedWithItsPlace) {
  const BadJson rows[] = {
      {"", "byte 1: this is no JSON"},
      {"{\"schema\": ", "byte 12: this is no JSON"},
      {"[]", "the report: there is no \"schema\""},
      {"{\"schema\":\"rubric.check/1\"}", "schema is \"rubric.check/1\"; this reads rubric.test/1"},
      {"{\"schema\":\"rubric.test/1\"}", "the report: there is no \"implementations\""},
      {"{\"schema\":\"rubric.test/1\",\"implementations\":{}}",
       "the report: implementations is no list"},
      {"{\"schema\":\"rubric.test/1\",\"implementations\":[{\"name\":1}]}",
       "implementations[0]: name is no text"},
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
  run.traces = {"my cases"};
  run.implementations[0].cases[0].seed = 9;
  EXPECT_EQ(replay_command(run, run.implementations[0], run.implementations[0].cases[0]),
            "rubric test --target './tiny it'\\''s' --cases a.pass --profile deployed --seed 9 "
            "'my cases'");
}

}  // namespace
}  // namespace rubric::suite
