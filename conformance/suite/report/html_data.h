// What the page of a report draws, as JSON.
#pragma once

#include <string>
#include <vector>

#include "conformance/suite/report/json.h"
#include "conformance/suite/result.h"

namespace rubric::suite {

/// Files of one case on one implementation, relative to the page; empty: none.
struct CaseLinks {
  std::string rtr;
  std::string pcapng;
};

/// One JSON object without "<", so that no text in it can end the script element that it stands in.
/// `links` by implementation and case. The keys are read in html/*.js alone.
std::string html_data(const SuiteRun& run, const EarlierRun* earlier,
                      const std::vector<std::vector<CaseLinks>>& links);

}  // namespace rubric::suite
