// The reference machine passes every golden trace.
#include <gtest/gtest.h>

#include <set>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"

namespace rubric::runner {
namespace {

std::unique_ptr<Target> machine_target(const trace::NodeHeader&) {
  return std::make_unique<SubjectTarget>(std::make_unique<Machine>());
}

TEST(GoldenCases, TheMachinePassesAll) {
  int cases = 0;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const CaseResult result = run_case(file.file, one, machine_target);
      EXPECT_EQ(result.verdict, CaseVerdict::kPass) << explain(result, file.file_name);
      ++cases;
    }
  }
  EXPECT_GT(cases, 270);
  std::printf("%d golden traces\n", cases);
}

TEST(GoldenCases, NamesAreUnique) {
  std::set<std::string> names;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) EXPECT_TRUE(names.insert(one.name).second);
  }
}

// A log of the machine holds for the machine again: logs are golden traces.
TEST(GoldenCases, LogsHoldAgain) {
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const CaseResult first = run_case(file.file, one, machine_target);
      trace::File again = file.file;
      trace::Case log = first.log;
      for (const trace::Item& item : one.items) {
        if (item.as<trace::Header>()) log.items.insert(log.items.begin(), item);
      }
      again.cases = {log};
      const CaseResult second = run_case(again, log, machine_target);
      EXPECT_EQ(second.verdict, CaseVerdict::kPass) << explain(second, one.name);
    }
  }
}

}  // namespace
}  // namespace rubric::runner
