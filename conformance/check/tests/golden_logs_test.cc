// The reference machine is right in the golden traces: none of its logs may be blamed.
#include <gtest/gtest.h>

#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing_log.h"
#include "conformance/test/report/case_files.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/tests/testing.h"

namespace rubric::check {
namespace {

TEST(GoldenLogs, NoLogOfAPassingCaseIsBlamed) {
  const suite::Cases cases = suite::Cases::own();
  suite::testing::FakeAttachment machine;
  std::size_t judged = 0;
  for (const suite::SuiteCase& one : cases.all()) {
    const suite::CaseRun run = suite::run_one(one, machine, "", std::nullopt);
    if (run.result.verdict != runner::CaseVerdict::kPass) continue;
    const std::string log = suite::case_rtr(run);
    for (const Finding& finding : judge(must_read(run.name, log), Options{}).findings) {
      EXPECT_NE(finding.severity, Severity::kFail) << run.name << ": " << finding.text;
    }
    ++judged;
  }
  EXPECT_GT(judged, cases.all().size() * 9 / 10);
}

}  // namespace
}  // namespace rubric::check
