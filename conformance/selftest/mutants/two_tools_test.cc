// `rubric test` and `rubric check` agree: the log of a legal variant's run, which the suite passes,
// is not blamed by the judge of logs.
#include <gtest/gtest.h>

#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/judge/judge.h"
#include "conformance/selftest/mutants/legal.h"
#include "conformance/test/report/case_files.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/test/testing.h"

namespace rubric::mutants {
namespace {

std::size_t judged = 0;

void compare(const suite::Cases& cases, const LegalVariant& variant) {
  suite::testing::FakeAttachment attached;
  attached.who.stated = variant.stated;
  attached.make = [&] { return std::make_unique<runner::SubjectTarget>(wrapped(variant.step)()); };
  for (const suite::SuiteCase& one : cases.all()) {
    const suite::CaseRun run = suite::run_one(one, attached, "", std::nullopt);
    if (run.result.verdict > runner::CaseVerdict::kWeak) continue;
    check::RunReader reader;
    std::string error;
    ASSERT_TRUE(reader.add_bytes(run.name, suite::case_rtr(run), error)) << error;
    for (const check::Finding& finding : check::judge(reader.finish(), {}).findings) {
      EXPECT_NE(finding.severity, check::Severity::kFail)
          << variant.name << ", " << run.name << ": "
          << reflect::requirement(finding.requirement).id << ' ' << finding.text;
    }
    ++judged;
  }
}

TEST(TwoTools, NoLogOfALegalVariantIsBlamed) {
  const suite::Cases cases = suite::Cases::own();
  std::size_t variants = 0;
  for (const auto& all : {legal_variants(), stated_variants()}) {
    for (const LegalVariant& variant : all) compare(cases, variant);
    variants += all.size();
  }
  EXPECT_GT(judged, variants * cases.all().size() * 9 / 10);
}

TEST(TwoTools, NoLogWithBackOffIsBlamed) {
  const suite::Cases cases = suite::Cases::own();
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    compare(
        cases,
        {"back_off", "", backing_off(seed, 10), false, {{trace::ParameterId::kChannelAccess, 30}}});
  }
}

}  // namespace
}  // namespace rubric::mutants
