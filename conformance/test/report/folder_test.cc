// The files that a report leaves in a folder that was used before, and those that it removes.
#include "conformance/test/report/folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <memory>
#include <set>
#include <vector>

#include "codec/text/files.h"
#include "conformance/test/report/html.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/test/testing.h"

namespace rubric::suite {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("folder-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void put(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) out.insert(fs::relative(entry.path(), folder).string());
  }
  return out;
}

TEST(ReportFolder, AUsedFolderLosesWhatAnEarlierReportLeftAndNothingElse) {
  Folder folder;
  const fs::path path = folder.path() / "used";
  put(path / "cases" / "machine" / "mine.rtr", "mine");
  put(path / "notes.txt", "mine");
  const Cases cases = Cases::own();
  Plan plan;
  for (const char* name : {"j4.accept", "j4.wrong_seq", "open_door"}) {
    plan.cases.push_back(*cases.find(name));
  }
  SuiteRun run;
  run.implementations.push_back(suite::run(
      "machine", [] { return std::make_unique<testing::FakeAttachment>(); }, plan));
  run.implementations[0].identity.name = "machine";
  run.implementations[0].identity.version = "";
  run.implementations.push_back(run.implementations[0]);
  run.implementations[1].identity.name = "retired";
  write_html_report(run, nullptr, path);
  EXPECT_TRUE(fs::exists(path / "cases" / "retired" / "open_door.pcapng"));
  put(path / "cases" / "machine" / "open_door.rtr", "changed since");

  run.implementations.pop_back();
  run.implementations[0].cases.resize(1);
  write_html_report(run, nullptr, path);
  const std::set<std::string> kept = {"cases/machine/j4.accept.pcapng",
                                      "cases/machine/j4.accept.rtr",
                                      "cases/machine/mine.rtr",
                                      "cases/machine/open_door.rtr",
                                      "index.html",
                                      "notes.txt",
                                      "report.files"};
  EXPECT_EQ(files_in(path), kept);
  EXPECT_FALSE(fs::exists(path / "cases" / "retired"));
  write_html_report(run, nullptr, path);
  EXPECT_EQ(files_in(path), kept);
}

TEST(ReportFolder, AnAccountThatLeadsElsewhereRemovesNothing) {
  Folder folder;
  const fs::path path = folder.path() / "report";
  const std::string sum = "af63f54c86021707";  // For "x".
  const std::vector<std::string> others = {"outside.txt", "report/linked/file.txt",
                                           "report/other/file.txt"};
  for (const std::string& other : others) put(folder.path() / other, "x");
  put(path / "old.txt", "x");
  fs::create_directory_symlink(folder.path() / "report" / "other", path / "link");
  fs::create_symlink(folder.path() / "outside.txt", path / "link.txt");
  put(path / "report.files", "rubric.files/1\n" + sum + " ../outside.txt\n" + sum + " " +
                                 (folder.path() / "outside.txt").string() + "\n" + sum +
                                 " link/file.txt\n" + sum + " link.txt\n" + sum +
                                 " ./linked/file.txt\n" + sum + " linked/../linked/file.txt\n" +
                                 sum + " old.txt\nnonsense\n");
  write_html_report(SuiteRun(), nullptr, path);
  for (const std::string& other : others) EXPECT_TRUE(fs::exists(folder.path() / other)) << other;
  EXPECT_TRUE(fs::is_symlink(path / "link.txt"));
  EXPECT_FALSE(fs::exists(path / "old.txt"));  // It is what the account says.
}

TEST(ReportFolder, SaysWhyAFileCannotBeWritten) {
  EXPECT_EQ(report::write_file("/dev/full", "x"), ENOSPC);
  EXPECT_EQ(report::write_file("/dev/null/x", "x"), ENOTDIR);
  EXPECT_EQ(report::write_file("/dev/null", "x"), 0);
}

}  // namespace
}  // namespace rubric::suite
