// The parts of a report, on findings made by hand; tools/tests/check/check_test.py tests what
// `rubric check` prints for captures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "conformance/check/report/chart.h"
#include "conformance/check/report/html.h"
#include "conformance/check/report/json.h"
#include "conformance/check/report/junit.h"
#include "conformance/check/report/text.h"
#include "conformance/check/report/words.h"
#include "conformance/check/tests/must_read.h"

namespace rubric::report {
namespace {

using check::Finding;
using check::Severity;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kCapture = "spec/captures/firmware/d2_lose_reply.pcapng";

Finding finding(ReqId requirement, Severity severity, std::uint64_t frame, std::string text) {
  Finding out{.requirement = requirement,
              .severity = severity,
              .place = {0, frame, 100 * frame, static_cast<std::int64_t>(frame) * 1000}};
  out.last = out.place;
  out.node = "mote 2";
  out.text = std::move(text);
  out.expected = "Nothing.";
  return out;
}

check::Report report_of(std::vector<Finding> findings) {
  check::Report out{.findings = std::move(findings)};
  for (const Finding& one : out.findings) {
    if (one.severity == Severity::kFail) out.verdict = check::Verdict::kFail;
  }
  out.frames = 9;
  out.exercised = {{"J4-SEQ"_rule, 3}};
  return out;
}

check::Run run_of(std::uint64_t frames) {
  check::Run run{.files = {"folder/a.pcapng"}};
  run.taps.resize(1);
  for (std::uint64_t i = 1; i <= frames; ++i) {
    check::Observation seen{.kind = check::Observation::Kind::kDamaged,
                            .place = {0, i, 100 * i, static_cast<std::int64_t>(i) * 1000}};
    run.seen.push_back(seen);
  }
  run.start_us = 1000;
  run.end_us = static_cast<std::int64_t>(frames) * 1000;
  return run;
}

check::Run capture() { return check::must_read({kCapture}); }

KnownFailures expecting(const std::string& text) { return parse_expectations(text, "known.yaml"); }

// Expectations.

struct BadFile {
  const char* text;
  const char* error;
};
const BadFile kBadFiles[] = {
    {"requirement: J4-SEQ\n", "known.yaml:1: expected a list of expectations"},
    {"- J4-SEQ\n", "known.yaml:1: expected requirement, message and reason"},
    {"- requirement: J4-SEK\n  message: m\n  reason: r\n",
     "known.yaml:1: no requirement is called 'J4-SEK'"},
    {"\n- requirement: J4-SEQ\n  message: m\n", "known.yaml:2: reason is missing"},
    {"- requirement: J4-SEQ\n  reason: m\n", "known.yaml:1: message is missing"},
    {"- message: J4-SEQ\n  reason: m\n", "known.yaml:1: requirement is missing"},
    {"- requirement: J4-SEQ\n  message: ''\n  reason: r\n",
     "known.yaml:2: message: expected a text"},
    {"- requirement: J4-SEQ\n  message: [m]\n  reason: r\n",
     "known.yaml:2: message: expected a text"},
    {"- requirement: J4-SEQ\n  message: m\n  reason: r\n  frame: 3\n",
     "known.yaml:4: unknown key 'frame'; known are requirement, node, file, profile, message, "
     "reason"},
    {"- requirement: J4-SEQ\n  message: m\n  message: m\n  reason: r\n",
     "known.yaml:3: message is given twice"},
    {"- requirement: J4-SEQ\n  message: m\n  reason: r\n  profile: papr\n",
     "known.yaml:4: profile is paper or deployed, not 'papr'"},
    {"- requirement: [\n", "known.yaml:2: end of sequence flow not found"},
};

TEST(Expectations, SayWhatIsWrongAndWhere) {
  for (const BadFile& bad : kBadFiles) {
    std::string error;
    try {
      expecting(bad.text);
    } catch (const std::runtime_error& refused) {
      error = refused.what();
    }
    EXPECT_EQ(error, bad.error) << bad.text;
  }
}

struct Row {
  const char* name;
  const char* more;  // Keys beside requirement, message and reason.
  const char* message;
  ExpectationState state;
  int code;
};
const Row kRows[] = {
    {"Match", "", "wrong number", ExpectationState::kMatched, 0},
    {"MatchOfNode", "node: mote 2", "wrong number", ExpectationState::kMatched, 0},
    {"MatchOfFile", "file: 'a.*'", "wrong number", ExpectationState::kMatched, 0},
    {"MatchOfPath", "file: 'folder/*'", "wrong number", ExpectationState::kMatched, 0},
    {"MatchOfProfile", "profile: paper", "wrong number", ExpectationState::kMatched, 0},
    {"OtherMessage", "", "another number", ExpectationState::kOtherMessage, 1},
    {"OtherNode", "node: mote 3", "wrong number", ExpectationState::kStale, 1},
    {"OtherFile", "file: b.pcapng", "wrong number", ExpectationState::kNotApplicable, 1},
    {"OtherProfile", "profile: deployed", "wrong number", ExpectationState::kNotApplicable, 1},
};

TEST(Expectations, OfAFailure) {
  const check::Run run = run_of(9);
  const check::Report report =
      report_of({finding("J4-SEQ"_rule, Severity::kFail, 4, "a wrong number")});
  for (const Row& row : kRows) {
    std::string text = "- requirement: J4-SEQ\n  reason: r\n  message: ";
    text += std::string(row.message) + "\n";
    if (*row.more != '\0') text += std::string("  ") + row.more + "\n";
    const Outcome outcome = compare(run, {}, report, expecting(text));
    EXPECT_EQ(state_name(outcome.results[0].state), state_name(row.state)) << row.name;
    EXPECT_EQ(outcome.exit_code(), row.code) << row.name;
    EXPECT_EQ(outcome.unexpected_failures, row.state == ExpectationState::kMatched ? 0u : 1u)
        << row.name;
  }
}

TEST(Expectations, AreNotAskedOfWhatIsInconclusive) {
  struct Undecided {
    const char* entry;
    Severity severity;
    ExpectationState state;
  };
  for (const Undecided& one : {
           Undecided{"J4-SEQ, message: a wrong number", Severity::kInconclusive,
                     ExpectationState::kNotApplicable},
           Undecided{"J4-SEQ, message: a wrong number", Severity::kWeak, ExpectationState::kStale},
           Undecided{"J4-SEQ, message: another number", Severity::kInconclusive,
                     ExpectationState::kStale},
           Undecided{"J4-CLOCK, message: a wrong number", Severity::kInconclusive,
                     ExpectationState::kStale},
       }) {
    const check::Report report =
        report_of({finding("J4-SEQ"_rule, one.severity, 4, "a wrong number")});
    const Outcome outcome =
        compare(run_of(9), {}, report,
                expecting(std::string("- {requirement: ") + one.entry + ", reason: r}"));
    EXPECT_EQ(state_name(outcome.results[0].state), state_name(one.state)) << one.entry;
    EXPECT_EQ(outcome.broken_expectations, one.state == ExpectationState::kStale ? 1u : 0u);
    EXPECT_EQ(outcome.expected_by[0], kUnexpected);
  }
}

TEST(Expectations, OneKnownFailureLeavesOthersUnexpected) {
  const check::Report report = report_of({finding("J4-SEQ"_rule, Severity::kFail, 4, "this"),
                                          finding("J4-SEQ"_rule, Severity::kFail, 5, "that")});
  const Outcome outcome = compare(run_of(9), {}, report,
                                  expecting("- {requirement: J4-SEQ, message: this, reason: r}"));
  EXPECT_EQ(outcome.results[0].state, ExpectationState::kMatched);
  EXPECT_EQ(outcome.expected_by, (std::vector<std::size_t>{0, kUnexpected}));
  EXPECT_EQ(outcome.exit_code(), 1);
}

TEST(ExitCodes, WithoutExpectations) {
  const auto code = [](check::Report report) {
    return compare(run_of(9), {}, report, {}).exit_code();
  };
  EXPECT_EQ(code(report_of({})), 0);
  EXPECT_EQ(code(report_of({finding("J4-SEQ"_rule, Severity::kWeak, 1, "x")})), 0);
  EXPECT_EQ(code(report_of({finding("J4-SEQ"_rule, Severity::kInconclusive, 1, "x")})), 0);
  EXPECT_EQ(code(report_of({finding("J4-SEQ"_rule, Severity::kFail, 1, "x")})), 1);
  check::Report nothing = report_of({finding("J4-SEQ"_rule, Severity::kInconclusive, 1, "x")});
  nothing.exercised.clear();
  EXPECT_EQ(code(nothing), 3);
  EXPECT_EQ(compare(run_of(9), {}, nothing, {}).verdict, check::Verdict::kInconclusive);
  nothing.findings[0].severity = Severity::kFail;
  EXPECT_EQ(code(nothing), 1);
  EXPECT_EQ(code({}), 3);
}

// Parts of runs.

TEST(Ranges, AreRead) {
  FrameRange range;
  std::string error;
  ASSERT_TRUE(parse_range("4..17", range, error));
  EXPECT_EQ(range_text(range, 1), "4..17");
  ASSERT_TRUE(parse_range("2:7", range, error));
  EXPECT_EQ(range_text(range, 2), "2:7..7");
  ASSERT_TRUE(parse_range("2:none", range, error));
  EXPECT_EQ(range_text(range, 3), "2:none");
  for (const char* bad : {"", "..", "4..", "..4", "a..b", "5..4", "0..3", "0:1..2", ":1..2",
                          "4...5", "-1..3", "99999999999999999999..1", "4294967296:1..2"}) {
    EXPECT_FALSE(parse_range(bad, range, error)) << bad;
    EXPECT_FALSE(error.empty());
  }
}

TEST(Windows, PartsDoNotStartCold) {
  const check::Run run = run_of(9);
  check::Options options{.start_cold = true};
  check::Run part = part_of(run, {{0, 1, 5}}, options);
  EXPECT_TRUE(options.start_cold);
  EXPECT_EQ(part.end_us, 5000);
  part = part_of(run, {{0, 4, 9}}, options);
  EXPECT_FALSE(options.start_cold);
  EXPECT_EQ(part.seen.size(), 6u);
  EXPECT_EQ(part.start_us, 4000);
}

// Finds something in frame 500, which needs frame 470 for a cause and 510 as a sign of life.
check::Report picky_judge(const check::Run& run, const check::Options&) {
  std::size_t needed = 0;
  for (const check::Observation& seen : run.seen) {
    const std::uint64_t frame = seen.place.frame;
    if (frame == 470 || frame == 500 || frame == 510) ++needed;
  }
  if (needed < 3) return {};
  return report_of({finding("J4-SEQ"_rule, Severity::kFail, 500, "x")});
}

TEST(Windows, AreSmallAndStillShowTheFinding) {
  const check::Run run = run_of(1000);
  check::Options options;
  Windows windows(run, options, picky_judge);
  const Finding found = finding("J4-SEQ"_rule, Severity::kFail, 500, "x");
  const std::vector<FrameRange> ranges = windows.around(found);
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_LE(ranges[0].first, 470u);
  EXPECT_GE(ranges[0].last, 510u);
  EXPECT_LT(ranges[0].last - ranges[0].first, 120u);
  EXPECT_EQ(picky_judge(part_of(run, ranges, options), options).findings.size(), 1u);
}

TEST(Windows, AreTheWholeRunWhereNothingLessWillDo) {
  const check::Run run = run_of(20);
  const Finding found = finding("J4-SEQ"_rule, Severity::kFail, 10, "x");
  const auto needs_all = [&](const check::Run& part, const check::Options&) {
    return part.seen.size() == 20 ? report_of({found}) : check::Report{};
  };
  const check::Options options;
  Windows windows(run, options, needs_all);
  EXPECT_TRUE(windows.around(found).empty());
}

// Charts.

TEST(Chart, OfAJoinWhoseReplyWasLost) {
  const check::Run run = capture();
  const Scene scene(run, {});
  EXPECT_EQ(chart(scene, {0, 1, 2, 3}, 3, 2, 80),
            "      time  frame  sink 11                 mote 2\n"
            "  0.000000      1     |<-join_request 50421---|\n"
            "  0.002472      2     |---join_reply 50421--->|\n"
            "  0.494904      3     |<-join_request 50421---|\n"
            "  0.503006      4     |===join_reply 50421===>|  <<<\n");
}

TEST(Chart, NarrowOnesPutLabelsBeside) {
  const check::Run run = capture();
  const Scene scene(run, {});
  EXPECT_THAT(chart(scene, {0}, 9, 0, 30), HasSubstr("|<----------|  join_request 50421\n"));
}

// Whole reports.

struct Told {
  check::Run run = capture();
  check::Options options;
  check::Report report;
  KnownFailures expected;
  Outcome outcome;
  explicit Told(std::vector<Finding> findings, const std::string& known = {}) {
    report = report_of(std::move(findings));
    if (!known.empty()) expected = expecting(known);
    outcome = compare(run, options, report, expected);
  }
  Story story() const { return {run, options, report, expected, outcome}; }
};

TEST(Text, FirstFailureOfARuleInFullOthersInALine) {
  std::vector<Finding> findings;
  for (std::uint64_t i = 1; i <= 6; ++i) {
    findings.push_back(finding("J4-SEQ"_rule, Severity::kFail, i, "It said " + std::to_string(i)));
  }
  findings[0].hypotheses = {{"It was so.", "This.", "Expected 1, seen 2."},
                            {"It was not.", "That.", "Expected 3, seen 2."}};
  findings[0].count = 3;
  findings[0].last.frame = 5;
  const Told told(findings);
  const std::string text = text_report(told.story(), {});
  EXPECT_THAT(text, HasSubstr("FAIL J4-SEQ, mote 2, frame 1 at 0.001000 s, 3 times up to frame 5\n"
                              "  It said 1\n"
                              "  Rule:     "));
  EXPECT_THAT(text, HasSubstr("the one that got furthest first:\n"
                              "   1. It was so.\n"
                              "      allowed next: This.\n"
                              "      nearest miss: Expected 1, seen 2.\n"
                              "   2. It was not.\n"
                              "      allowed next: That.\n"
                              "      missed:       Expected 3, seen 2.\n"));
  EXPECT_THAT(text, HasSubstr("FAIL J4-SEQ, mote 2, frame 2 at 0.002000 s: It said 2\n"));
  EXPECT_THAT(text, HasSubstr("  and 2 more of J4-SEQ (--verbose lists them)\n"));
  EXPECT_THAT(text, Not(HasSubstr("It said 6")));
  EXPECT_THAT(text, HasSubstr("Verdict: fail: 6 failures; 9 frames judged, 1 rule exercised.\n"));
  EXPECT_THAT(text, Not(HasSubstr("\033")));
  TextOptions verbose;
  verbose.verbose = true;
  verbose.color = true;
  const std::string all = text_report(told.story(), verbose);
  EXPECT_THAT(all, HasSubstr("It said 6"));
  EXPECT_THAT(all, HasSubstr("\033[1;31mFAIL\033[0m J4-SEQ"));
}

TEST(Html, ShowsSoManyOfARuleInFull) {
  std::vector<Finding> findings;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    findings.push_back(finding("J4-SEQ"_rule, Severity::kFail, i, "It said " + std::to_string(i)));
  }
  const Told told(findings);
  TextOptions options;
  options.verbose = true;
  options.findings_max = 2;
  const std::string page = html_report(told.story(), options, "");
  const std::size_t line = page.find("<br>It said 3</p>");
  EXPECT_NE(line, page.npos);
  EXPECT_LT(page.rfind("<br>It said 2</summary>"), line);
  EXPECT_EQ(page.find("<pre", line), page.npos);
  EXPECT_THAT(page,
              HasSubstr("The first 2 of a rule are shown in full; --max-findings N shows N."));
  options.findings_max = 3;
  EXPECT_THAT(html_report(told.story(), options, ""), Not(HasSubstr("--max-findings")));
}

TEST(Text, KnownStaleAndChangedFailures) {
  const Told told({finding("J4-SEQ"_rule, Severity::kFail, 2, "A wrong number."),
                   finding("J3-TIME"_rule, Severity::kFail, 3, "No growth.")},
                  "- {requirement: J4-SEQ, message: wrong number, reason: Never repaired.}\n"
                  "- {requirement: J3-TIME, message: backwards, reason: r}\n"
                  "- {requirement: J8-LIMIT, message: sixth, reason: r}\n");
  const std::string text = text_report(told.story(), {});
  EXPECT_THAT(text, HasSubstr("EXPECTED FAIL J4-SEQ, mote 2, frame 2 at 0.002000 s: A wrong "
                              "number. Expected: Never repaired.\n"));
  EXPECT_THAT(text, HasSubstr("OTHER MESSAGE known.yaml:2: J3-TIME was expected to say "
                              "\"backwards\", but frame 3 at 0.003000 s says:\n  No growth.\n"));
  EXPECT_THAT(text, HasSubstr("STALE known.yaml:3: J8-LIMIT does not fail with \"sixth\" any "
                              "more."));
  EXPECT_THAT(text, HasSubstr("Verdict: fail: 1 failure, 1 known failure expected, 2 expectations "
                              "not true;"));
}

TEST(Json, EscapesWhatItSays) {
  const Told told({finding("J4-SEQ"_rule, Severity::kFail, 2, "\"<\xFF>\"")});
  const std::string json = json_report(told.story()).text();
  EXPECT_THAT(json, HasSubstr("{\"schema\":\"rubric.check/1\",\n\"verdict\":\"fail\",\n"
                              "\"expected\":false,\n\"exit_code\":1,\n"));
  EXPECT_THAT(json, HasSubstr("\"severity\":\"fail\",\"time\":0.002000,\"file\":\"" +
                              std::string(kCapture) +
                              "\",\"frame\":2,\"offset\":200,"
                              "\"node\":\"mote 2\",\"text\":\"\\\"<\xEF\xBF\xBD>\\\"\""));
}

TEST(Junit, FailuresSkippedAndKnown) {
  const Told told({finding("J4-SEQ"_rule, Severity::kFail, 2, "\"<wrong>\" & so on"),
                   finding("J3-TIME"_rule, Severity::kInconclusive, 3, "Who knows."),
                   finding("J8-LIMIT"_rule, Severity::kFail, 4, "The 6th.")},
                  "- {requirement: J8-LIMIT, message: 6th, reason: Release 1.0.}\n"
                  "- {requirement: J8-LIMIT, message: 7th, reason: r}\n");
  const std::string xml = junit_report(told.story());
  EXPECT_THAT(xml, HasSubstr("tests=\"5\" failures=\"2\" errors=\"0\" skipped=\"1\""));
  EXPECT_THAT(xml, HasSubstr("<failure type=\"MUST\" message=\"mote 2, frame 2 at 0.002000 s: "
                             "&quot;&lt;wrong&gt;&quot; &amp; so on\">"));
  EXPECT_THAT(xml, HasSubstr("<skipped message=\"mote 2, frame 3 at 0.003000 s: Who knows.\"/>"));
  EXPECT_THAT(xml, HasSubstr("fail: mote 2, frame 4 at 0.004000 s: The 6th. Known: Release 1.0."));
  EXPECT_THAT(xml, HasSubstr("<failure type=\"other_message\""));
}

}  // namespace
}  // namespace rubric::report
