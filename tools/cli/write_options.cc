#include "tools/cli/write_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "codec/text/packed.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/cli/quantity.h"

namespace rubric::cli {
void add_write_options(Command& command, WriteOptions& options, const std::string& description,
                       bool rotates, bool with_log) {
  const Option write = command.add_option("--write", options.path, description);
  Option force = command.add_flag(
      "--force", options.force,
      fmt::format("Let a --write {}that grows replace an old file", with_log ? "or --log " : ""));
  if (!with_log) force.needs(write);
  if (!rotates) return;
  const auto check = [](const std::string& text) {
    return parse_quantity(text) ? "" : "expected a size or time as in 100M or 24h, given " + text;
  };
  command
      .add_option("--rotate", options.rotate,
                  "Go on in a next file, as in FILE.2.pcapng, after this size (k, M, G) or time "
                  "(s, min, h, d)")
      .check(check, "SIZE|TIME")
      .needs(write);
}

lines::Rotation rotation_of(const WriteOptions& options) {
  const Quantity after = parse_quantity(options.rotate).value_or(Quantity{});
  return {after.bytes, std::chrono::seconds(after.seconds)};
}

void check_place(const std::string& option, const std::string& path, bool replaces) {
  std::error_code none;
  const std::filesystem::path file(path);
  if (!replaces && std::filesystem::is_regular_file(file, none)) {
    throw UsageError(option, path + " exists; --force replaces it");
  }
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (!std::filesystem::exists(file, none) && ::access(folder.c_str(), W_OK | X_OK) != 0) {
    is_written(path, errno);
    exit_with(kExitOutput);
  }
}

void check_write(const WriteOptions& options, const std::vector<std::string>& inputs, bool grows) {
  if (options.path.empty()) return;
  keep_apart("--write", options.path, inputs);
  if (!grows && !options.rotate.empty()) {
    throw UsageError("--rotate", "is for captures that grow: no source is a line or --follow");
  }
  if (text::packing_of_name(options.path) != text::Packing::kNone) {
    throw UsageError("--write", options.path +
                                    ": captures that grow are not compressed; 'rubric "
                                    "convert' does it afterwards");
  }
  check_place("--write", options.path, !grows || options.force);
}

}  // namespace rubric::cli
