#include "conformance/test/report/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
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

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw std::runtime_error(path.string() + ": " + error.message());
}

}  // namespace

ReportFolder::ReportFolder(fs::path folder) : folder_(std::move(folder)) { make_folder(folder_); }

void ReportFolder::write(const std::string& path, std::string_view text) {
  const fs::path to = folder_ / path;
  make_folder(to.parent_path());
  if (const int error = report::write_file(to.string(), text); error != 0) {
    throw std::runtime_error(to.string() + ": cannot be written: " + std::strerror(error));
  }
  written_[path] = sum_of(text);
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

void ReportFolder::finish() {
  for (const auto& [path, sum] : read_account()) {
    if (!written_.contains(path)) remove(path, sum);
  }
  std::string account = std::string(kTitle) + '\n';
  for (const auto& [path, sum] : written_) account += sum + ' ' + path + '\n';
  const fs::path to = folder_ / kAccount;
  if (const int error = report::write_file(to.string(), account); error != 0) {
    throw std::runtime_error(to.string() + ": cannot be written: " + std::strerror(error));
  }
}

}  // namespace rubric::suite
