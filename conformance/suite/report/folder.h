// The folder of a report: what is written into it, and what an earlier report left there.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace rubric::suite {

/// Writes files into a folder and keeps account of them in its file `report.files`, so that the
/// next report can remove those that it has no more. Nothing else is ever removed: no file that the
/// account does not have, that somebody has changed since, or that a link leads to.
class ReportFolder {
 public:
  /// Makes the folder. Throws std::runtime_error with path and reason, as write() and finish() do.
  explicit ReportFolder(std::filesystem::path folder);

  /// `path` has '/' between its parts, no "." or ".." among them, and no line end. Makes folders.
  void write(const std::string& path, std::string_view text);
  /// Removes what an earlier report wrote and this one did not, with folders that are empty then,
  /// and writes the account.
  void finish();

 private:
  using Account = std::map<std::string, std::string>;  // Check sums of files by path.

  Account read_account() const;
  void remove(const std::string& path, const std::string& sum) const;

  std::filesystem::path folder_;
  Account written_;
};

}  // namespace rubric::suite
