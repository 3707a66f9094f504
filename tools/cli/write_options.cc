#include "tools/cli/write_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"

namespace rubric::cli {
namespace {

struct RotationUnit {
  std::string_view name;
  std::uint64_t bytes;
  std::int64_t seconds;
};
constexpr RotationUnit kRotationUnits[] = {
    {"k", 1ULL << 10, 0}, {"M", 1ULL << 20, 0}, {"G", 1ULL << 30, 0}, {"s", 0, 1},
    {"min", 0, 60},       {"h", 0, 3'600},      {"d", 0, 86'400},
};

std::optional<lines::Rotation> parse_rotation(const std::string& text) {
  constexpr std::uint64_t kMost = 1'000'000;
  char* end = nullptr;
  errno = 0;
  const std::uint64_t number = std::strtoull(text.c_str(), &end, 10);
  if (end == text.c_str() || text[0] == '-' || number == 0 || number > kMost) return std::nullopt;
  for (const RotationUnit& unit : kRotationUnits) {
    if (unit.name != end) continue;
    return lines::Rotation{number * unit.bytes,
                           std::chrono::seconds(static_cast<std::int64_t>(number) * unit.seconds)};
  }
  return std::nullopt;
}

}  // namespace

void add_write_options(Command& command, WriteOptions& options, const std::string& description,
                       bool rotates) {
  const Option write = command.add_option("--write", options.path, description).check(given);
  command.add_flag("--force", options.force, "Let a --write that grows replace an old file")
      .needs(write);
  if (!rotates) return;
  const auto check = [](const std::string& text) {
    return parse_rotation(text) ? "" : "expected a size or time as in 100M or 24h, given " + text;
  };
  command
      .add_option("--rotate", options.rotate,
                  "Go on in a next file, FILE.2, after this size (k, M, G) or time (s, min, h, d)")
      .check(check, "SIZE|TIME")
      .needs(write);
}

lines::Rotation rotation_of(const WriteOptions& options) {
  return parse_rotation(options.rotate).value_or(lines::Rotation{});
}

void check_write(const WriteOptions& options, const std::vector<std::string>& inputs, bool grows) {
  if (options.path.empty()) return;
  keep_apart("--write", options.path, inputs);
  std::error_code none;
  const std::filesystem::path path(options.path);
  if (grows && !options.force && std::filesystem::is_regular_file(path, none)) {
    throw UsageError("--write", options.path + " exists; --force replaces it");
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::exists(path, none) && ::access(folder.c_str(), W_OK | X_OK) != 0) {
    fmt::print(stderr, "rubric: cannot write {}: {}\n", options.path, std::strerror(errno));
    exit_with(kExitOutput);
  }
}

}  // namespace rubric::cli
