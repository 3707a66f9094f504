// Folders of reports, for tests.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "conformance/test/report/folder.h"
#include "conformance/test/report/html.h"

namespace rubric::suite {

/// Returns the files in the folder and in those within it, with relative paths.
inline std::set<std::string> files_in(const std::filesystem::path& folder) {
  std::set<std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) {
      out.insert(std::filesystem::relative(entry.path(), folder).generic_string());
    }
  }
  return out;
}

/// A folder for reports, until the end of a test.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("report-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }
  std::string read(const std::filesystem::path& name) const {
    std::ifstream in(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  std::set<std::string> files() const { return files_in(path_); }

 private:
  std::filesystem::path path_;
};

inline void report(const SuiteRun& run, const std::filesystem::path& path) {
  ReportFolder folder(path);
  write_html_report(run, nullptr, folder);
  folder.finish();
}

}  // namespace rubric::suite
