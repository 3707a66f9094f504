// `--report FOLDER`, which several commands have.
#pragma once

#include <string>
#include <vector>

#include "conformance/test/report/folder.h"
#include "tools/cli/command.h"

namespace rubric::tools {

/// Throws cli::UsageError if the report may replace one of the files; "-" is stdin.
inline void keep_report_apart(const std::string& folder, const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const std::string path = file == "-" ? "/dev/stdin" : file;
    if (!folder.empty() && suite::ReportFolder::may_replace(folder, path)) {
      throw cli::UsageError("--report", file + " is where the report puts a file of its own");
    }
  }
}

}  // namespace rubric::tools
