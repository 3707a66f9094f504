// Writes a run of the suite for people: a folder with one self-contained page and each case's log
// and capture.
#pragma once

#include <string>
#include <vector>

#include "conformance/test/report/folder.h"
#include "conformance/test/report/json.h"
#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Writes index.html and cases/IMPLEMENTATION/CASE.{rtr,pcapng} into the folder, and leaves it to
/// the caller to finish it. With `earlier` the page shows which verdicts changed since, which cases
/// are new, and which are gone. Throws as the folder does.
void write_html_report(const SuiteRun& run, const EarlierRun* earlier, ReportFolder& folder);

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
