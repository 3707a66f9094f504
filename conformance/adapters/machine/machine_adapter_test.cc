// The reference machine gives the same results for every golden trace through rct/1 as in this
// process.
#include <gtest/gtest.h>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/targets/attachment.h"

namespace rubric::targets {
namespace {

TEST(MachineAdapter, DoesWhatTheMachineDoesInEveryGoldenTrace) {
  const auto here = attach("machine", {});
  const auto there = attach(RUBRIC_MACHINE_ADAPTER, {});
  std::size_t cases = 0;
  for (const trace::Parsed& file : runner::load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const auto run = [&](Attachment& attachment) {
        return runner::run_case(file.file, one,
                                [&](const trace::NodeHeader&) { return attachment.target(); });
      };
      const runner::CaseResult expected = run(*here);
      const runner::CaseResult result = run(*there);
      EXPECT_EQ(result.verdict, runner::CaseVerdict::kPass)
          << runner::explain(result, file.file_name) << result.reason;
      EXPECT_EQ(result.log.text(), expected.log.text()) << one.name;
      ++cases;
    }
  }
  EXPECT_GT(cases, 250U);
  EXPECT_EQ(there->honesty(), "");
  EXPECT_EQ(there->take_stderr(), "");
}

TEST(MachineAdapter, SaysWhoItIs) {
  const Identity machine = attach("machine", {})->identity();
  const Identity adapter = attach(RUBRIC_MACHINE_ADAPTER, {})->identity();
  EXPECT_EQ(adapter.name, machine.name);
  EXPECT_EQ(adapter.version, machine.version);
  EXPECT_EQ(adapter.roles, machine.roles);
  EXPECT_FALSE(adapter.real_time);
}

}  // namespace
}  // namespace rubric::targets
