// Whole logs made by hand: violators that once passed, and conformers that once failed.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "conformance/check/test/failures.h"
#include "conformance/check/test/testing_log.h"

namespace rubric::check {
namespace {

TEST(Verdicts, OfWholeLogs) {
  std::ifstream file("conformance/check/test/testdata/whole_logs.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::size_t logs = 0;
  for (std::size_t at = text.find("\n== "); at != text.npos; ++logs) {
    const std::size_t colon = text.find(':', at);
    const std::size_t begin = text.find('\n', colon) + 1;
    const std::string rules = text.substr(at + 4, colon - at - 4);
    const std::string what = text.substr(colon + 2, begin - colon - 3);
    at = text.find("\n== ", begin);
    const std::size_t end = at == text.npos ? text.size() : at + 1;
    EXPECT_EQ(broken_in(judge_log(text.substr(begin, end - begin))),
              rules == "nothing" ? "" : rules)
        << what;
  }
  EXPECT_GT(logs, 25U);
}

}  // namespace
}  // namespace rubric::check
