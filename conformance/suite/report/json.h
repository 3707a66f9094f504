// A run of the suite for programs: schema rubric.test/1, see tools/test_format.md.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// One JSON object and a line end. All keys are always there.
std::string json_report(const SuiteRun& run);

/// What an earlier run said, as far as a comparison needs it: verdicts by name of implementation,
/// whatever its version, and case; the last of repeated ones.
struct EarlierRun {
  std::map<std::pair<std::string, std::string>, std::string> verdicts;
};
/// Reads what json_report() wrote. Throws std::runtime_error with place and reason.
EarlierRun read_json_report(std::string_view text);

}  // namespace rubric::suite
