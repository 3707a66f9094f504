// The reference machine passes every golden trace, and each has a name of its own. That their logs
// hold again is held by html_test.cc.
#include <gtest/gtest.h>

#include <set>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"

namespace rubric::runner {
namespace {

TEST(GoldenCases, TheMachinePassesAll) {
  std::set<std::string> names;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      EXPECT_TRUE(names.insert(one.name).second) << one.name;
      const CaseResult result = run_case(file.file, one, [](const trace::NodeHeader&) {
        return std::make_unique<SubjectTarget>(std::make_unique<Machine>());
      });
      EXPECT_EQ(result.verdict, CaseVerdict::kPass) << explain(result, file.file_name);
    }
  }
  EXPECT_GT(names.size(), 270U);
  std::printf("%zu golden traces\n", names.size());
}

}  // namespace
}  // namespace rubric::runner
