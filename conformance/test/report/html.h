// Writes a run of the suite for people: a folder with one self-contained page and each case's log
// and capture.
#pragma once

#include <filesystem>

#include "conformance/test/report/json.h"
#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Writes DIR/index.html and DIR/cases/IMPLEMENTATION/CASE.{rtr,pcapng}; makes the folders, and
/// removes what an earlier report left of cases that no longer exist (ReportFolder). With `earlier`
/// the page shows which verdicts changed since, which cases are new, and which are gone. Throws
/// std::runtime_error with the path that could not be written.
void write_html_report(const SuiteRun& run, const EarlierRun* earlier,
                       const std::filesystem::path& path);

}  // namespace rubric::suite
