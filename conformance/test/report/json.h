// A run of the suite for programs: schema rubric.test/1, see tools/commands/test_format.md.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/report/compare.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Returns one JSON object and a line end. All keys are always there.
std::string json_report(const SuiteRun& run);
/// Lists cases without running them: one object of the schema rubric.test.list/1.
std::string json_list(const std::vector<SuiteCase>& cases);

/// Parts that other reports build on: a case without its log, an implementation without its cases.
nlohmann::ordered_json case_json(const CaseRun& one);
nlohmann::ordered_json implementation_json(const ImplementationRun& run);
nlohmann::ordered_json stale_json(const SuiteRun& run);

/// Reads what json_report() wrote. Throws std::runtime_error with place and reason.
EarlierRun read_json_report(std::string_view text);

}  // namespace rubric::suite
