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
#include "conformance/test/report/folder_testing.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/tests/testing.h"

namespace rubric::suite {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
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
  report(run, path);
  EXPECT_TRUE(fs::exists(path / "cases" / "retired" / "open_door.pcapng"));
  put(path / "cases" / "machine" / "open_door.rtr", "changed since");

  run.implementations.pop_back();
  run.implementations[0].cases.resize(1);
  report(run, path);
  const std::set<std::string> kept = {"cases/machine/j4.accept.pcapng",
                                      "cases/machine/j4.accept.rtr",
                                      "cases/machine/mine.rtr",
                                      "cases/machine/open_door.rtr",
                                      "index.html",
                                      "notes.txt",
                                      "report.files"};
  EXPECT_EQ(files_in(path), kept);
  EXPECT_FALSE(fs::exists(path / "cases" / "retired"));
  report(run, path);
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
  report(SuiteRun(), path);
  for (const std::string& other : others) EXPECT_TRUE(fs::exists(folder.path() / other)) << other;
  EXPECT_TRUE(fs::is_symlink(path / "link.txt"));
  EXPECT_FALSE(fs::exists(path / "old.txt"));  // It is what the account says.
}

TEST(ReportFolder, WritesThroughNoLink) {
  Folder folder;
  const fs::path path = folder.path() / "report";
  put(folder.path() / "outside.html", "mine");
  put(folder.path() / "outside" / "keep.txt", "mine");
  fs::create_directories(path);
  fs::create_symlink(folder.path() / "outside.html", path / "index.html");
  report(SuiteRun(), path);
  EXPECT_FALSE(fs::is_symlink(path / "index.html"));
  EXPECT_EQ(fs::file_size(folder.path() / "outside.html"), 4U);

  fs::create_directory_symlink(folder.path() / "outside", path / "cases");
  ReportFolder linked(path);
  EXPECT_THROW(linked.write("cases/machine/a.rtr", "x"), std::system_error);
  EXPECT_EQ(files_in(folder.path() / "outside"), std::set<std::string>{"keep.txt"});
}

// It is named by who runs the test, as `latest` may lead to the run of today.
TEST(ReportFolder, TheFolderItselfMayBeALink) {
  Folder folder;
  const fs::path path = folder.path() / "report";
  fs::create_directories(path);
  fs::create_directory_symlink(path, folder.path() / "latest");
  report(SuiteRun(), folder.path() / "latest");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "latest"));
  EXPECT_TRUE(fs::exists(path / "index.html"));
  fs::create_directory_symlink(folder.path() / "absent", folder.path() / "nowhere");
  EXPECT_THROW(ReportFolder(folder.path() / "nowhere"), std::system_error);
  EXPECT_FALSE(fs::exists(folder.path() / "absent"));
}

TEST(ReportFolder, KeepsTheOldReportUntilTheNewOneIsWhole) {
  Folder folder;
  const fs::path path = folder.path() / "report";
  report(SuiteRun(), path);
  const std::set<std::string> old = files_in(path);
  {
    ReportFolder broken(path);
    broken.write("cases/machine/a.rtr", "x");
    broken.write("index.html", "new");
  }
  EXPECT_EQ(files_in(path), old);
  EXPECT_GT(fs::file_size(path / "index.html"), 3U);
}

TEST(ReportFolder, PutsOldFilesBackIfOneCannotBeReplaced) {
  Folder folder;
  const fs::path path = folder.path() / "report";
  const auto fill = [](ReportFolder& report, const std::string& text) {
    for (const char* name : {"a.txt", "index.html"}) report.write(name, text);
  };
  {
    ReportFolder report(path);
    fill(report, "old");
    report.finish();
  }
  {
    ReportFolder report(path);
    fill(report, "new");
    for (const char* name : {"b.txt", "c.txt"}) report.write(name, "new");
    put(path / "c.txt" / "mine.txt", "mine");
    EXPECT_THROW(report.finish(), std::system_error);
  }
  EXPECT_EQ(files_in(path),
            (std::set<std::string>{"a.txt", "c.txt/mine.txt", "index.html", "report.files"}));
  for (const char* name : {"a.txt", "index.html"}) {
    std::string text;
    EXPECT_EQ(text::read_file((path / name).string(), text), 0);
    EXPECT_EQ(text, "old") << name;
  }
}

TEST(ReportFolder, SaysWhyAFileCannotBeWritten) {
  EXPECT_EQ(text::write_file("/dev/full", "x"), ENOSPC);
  EXPECT_EQ(text::write_file("/dev/null/x", "x"), ENOTDIR);
  EXPECT_EQ(text::write_file("/dev/null", "x"), 0);
}

}  // namespace
}  // namespace rubric::suite
