// The folder of a report: writes into it, and removes what an earlier report left there.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::suite {

/// Writes files into a folder and lists them in its file `report.files`, so that the next report
/// can remove those that it no longer has. All files are on the disk, beside the old ones, before
/// the first of them is replaced; index.html, which leads to the others, is the last, and all are
/// put back if one cannot be replaced. Writes through no link. Removes nothing else: no file that
/// the list does not have, that somebody has changed since, or that a link leads to.
class ReportFolder {
 public:
  /// Files of reports, beside those of cases, which are in folders of kCases.
  static constexpr const char* kPage = "index.html";
  static constexpr const char* kJson = "report.json";
  static constexpr const char* kJunit = "junit.xml";
  static constexpr const char* kTap = "report.tap";
  static constexpr const char* kCases = "cases";
  /// Returns whether a report in `folder` may replace the file, by whatever name or link.
  static bool may_replace(const std::filesystem::path& folder, const std::filesystem::path& file);

  /// Makes the folder. Throws std::system_error with the path, as write() and finish() do.
  explicit ReportFolder(std::filesystem::path folder);
  /// Removes what was written, unless finish() was called.
  ~ReportFolder();
  ReportFolder(const ReportFolder&) = delete;
  ReportFolder& operator=(const ReportFolder&) = delete;

  /// Writes a file and makes its folders. `path` has '/' between its parts, no "." or ".." among
  /// them, and no line end.
  void write(const std::string& path, std::string_view text);
  /// Gives the files their places. Removes files of an earlier report that this one did not write,
  /// and folders that are empty then.
  void finish();

 private:
  using Account = std::map<std::string, std::string>;  // Check sums of files by path.

  Account read_account() const;
  void remove(const std::string& path, const std::string& sum) const;

  void stage(const std::string& path, std::string_view text) const;
  void stage_account(const Account& files) const;
  void flush() const;
  void place(const std::string& path);
  void undo();

  std::filesystem::path folder_;
  std::filesystem::path staged_;  // A folder in it.
  Account written_;
  std::vector<std::string> placed_;  // By finish().
};

}  // namespace rubric::suite
