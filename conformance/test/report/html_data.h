// The data that a report's page draws, as JSON.
#pragma once

#include <string>
#include <vector>

#include "conformance/test/report/json.h"
#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Files of one case on one implementation, relative to the page; empty: none.
struct CaseLinks {
  std::string rtr;
  std::string pcapng;
};

/// Returns one JSON object without "<", so that no text in it can end the script element around it.
/// `links` by implementation and case. Only html/*.js reads the keys.
std::string html_data(const SuiteRun& run, const EarlierRun* earlier,
                      const std::vector<std::vector<CaseLinks>>& links);

}  // namespace rubric::suite
