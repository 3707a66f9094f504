#include "conformance/test/report/folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "codec/text/files.h"

namespace rubric::suite {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAccount = "report.files";
constexpr const char* kTitle = "rubric.files/1";

// FNV-1a with 64 bits: it detects that a file was changed and resists no attacker.
std::string sum_of(std::string_view text) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char c : text) sum = (sum ^ static_cast<std::uint8_t>(c)) * 0x100000001b3U;
  return fmt::format("{:016x}", sum);
}

std::optional<std::string> content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof()) return std::nullopt;
  return text;
}

// Returns whether a path of the account stays inside the folder, whoever wrote it.
bool is_inside(const fs::path& path) {
  return !path.empty() && path.is_relative() &&
         std::none_of(path.begin(), path.end(), [](const fs::path& part) {
           return part.empty() || part == "." || part == "..";
         });
}

[[noreturn]] void cannot_write(const fs::path& path, int error) {
  throw std::system_error(error, std::generic_category(), path.string());
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) cannot_write(path, error.value());
}

bool swap_files(const fs::path& one, const fs::path& other) {
  return ::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

bool ReportFolder::may_replace(const fs::path& folder, const fs::path& file) {
  std::error_code none;
  const fs::path real = fs::weakly_canonical(file, none);
  for (const char* name : {kPage, kJson, kJunit, kTap, kAccount}) {
    const fs::path to = folder / name;
    if (fs::equivalent(to, file, none) || fs::weakly_canonical(to, none) == real) return true;
  }
  return real.parent_path().parent_path() == fs::weakly_canonical(folder / kCases, none);
}

ReportFolder::ReportFolder(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_);
  std::string name = (folder_ / ".report.XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) cannot_write(folder_, errno);
  staged_ = name;
}

ReportFolder::~ReportFolder() {
  std::error_code ignored;
  fs::remove_all(staged_, ignored);
}

void ReportFolder::stage(const std::string& path, std::string_view text) const {
  const fs::path to = staged_ / path;
  make_folder(to.parent_path());
  text::OutFile file(to.string(), text::OutFile::Mode::kGrow);
  int error = text::write_all(file.fd(), text);
  if (error == 0) error = file.finish();
  if (error != 0) cannot_write(folder_ / path, error);
}

void ReportFolder::write(const std::string& path, std::string_view text) {
  std::error_code none;
  fs::path at = folder_;
  for (const fs::path& part : fs::path(path).parent_path()) {
    at /= part;
    if (fs::is_symlink(fs::symlink_status(at, none))) cannot_write(at, ELOOP);
  }
  if (fs::is_directory(fs::symlink_status(folder_ / path, none))) {
    cannot_write(folder_ / path, EISDIR);
  }
  stage(path, text);
  written_[path] = sum_of(text);
}

// Old files go where the new ones were staged, so that undo() can put them back.
void ReportFolder::place(const std::string& path) {
  const fs::path from = staged_ / path;
  const fs::path to = folder_ / path;
  std::error_code error;
  const bool swapped = swap_files(from, to);
  if (swapped && fs::is_directory(fs::symlink_status(from, error))) {  // It came meanwhile.
    swap_files(from, to);
    cannot_write(to, EISDIR);
  }
  const bool is_new = !fs::exists(fs::symlink_status(to, error));
  if (!swapped) fs::rename(from, to, error);
  if (!swapped && error) cannot_write(to, error.value());
  // Where a file system cannot swap, an old file is gone.
  if (swapped || is_new) placed_.push_back(path);
}

void ReportFolder::undo() {
  std::error_code ignored;
  for (; !placed_.empty(); placed_.pop_back()) {
    const fs::path from = staged_ / placed_.back();
    const fs::path to = folder_ / placed_.back();
    if (!swap_files(from, to) && errno == ENOENT) fs::remove(to, ignored);  // There was none.
  }
}

ReportFolder::Account ReportFolder::read_account() const {
  Account out;
  const std::optional<std::string> text = content_of(folder_ / kAccount);
  if (!text) return out;
  std::istringstream lines(*text);
  std::string line;
  if (!std::getline(lines, line) || line != kTitle) return out;
  while (std::getline(lines, line)) {
    const std::size_t blank = line.find(' ');
    if (blank != line.npos) out[line.substr(blank + 1)] = line.substr(0, blank);
  }
  return out;
}

void ReportFolder::remove(const std::string& path, const std::string& sum) const {
  if (!is_inside(path)) return;
  std::error_code ignored;
  fs::path at = folder_;
  for (const fs::path& part : fs::path(path)) {
    at /= part;
    if (fs::is_symlink(fs::symlink_status(at, ignored))) return;
  }
  if (!fs::is_regular_file(at, ignored)) return;
  const std::optional<std::string> text = content_of(at);
  if (!text || sum_of(*text) != sum) return;
  fs::remove(at, ignored);
  for (fs::path above = fs::path(path).parent_path(); !above.empty(); above = above.parent_path()) {
    if (!fs::is_empty(folder_ / above, ignored) || ignored) return;
    fs::remove(folder_ / above, ignored);
  }
}

void ReportFolder::stage_account(const Account& files) const {
  std::string text = std::string(kTitle) + '\n';
  for (const auto& [path, sum] : files) text += sum + ' ' + path + '\n';
  stage(kAccount, text);
}

void ReportFolder::flush() const {
  const int fd = ::open(staged_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int error = fd < 0 || ::syncfs(fd) != 0 ? errno : 0;
  if (fd >= 0) ::close(fd);
  if (error != 0) cannot_write(folder_, error);
}

void ReportFolder::finish() {
  const Account old = read_account();
  Account all = written_;
  all.insert(old.begin(), old.end());  // Until they are removed.
  stage_account(all);
  flush();
  try {
    for (const auto& [path, sum] : written_) make_folder((folder_ / path).parent_path());
    for (const auto& [path, sum] : written_) {
      if (path != kPage) place(path);
    }
    place(kAccount);
    if (written_.contains(kPage)) place(kPage);
  } catch (const std::system_error&) {
    undo();
    throw;
  }
  placed_.clear();
  for (const auto& [path, sum] : old) {
    if (!written_.contains(path)) remove(path, sum);
  }
  if (all.size() == written_.size()) return;
  fs::remove(staged_ / kAccount);  // The one before.
  stage_account(written_);
  place(kAccount);
}

}  // namespace rubric::suite
