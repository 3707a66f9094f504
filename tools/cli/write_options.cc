#include "tools/cli/write_options.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "codec/text/packed.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/cli/quantity.h"

namespace rubric::cli {
void add_write_options(Command& command, WriteOptions& options, const std::string& description,
                       bool rotates) {
  const Option write = command.add_option("--write", options.path, description).check(given);
  command.add_flag("--force", options.force, "Let a --write that grows replace an old file")
      .needs(write);
  if (!rotates) return;
  const auto check = [](const std::string& text) {
    return parse_quantity(text) ? "" : "expected a size or time as in 100M or 24h, given " + text;
  };
  command
      .add_option("--rotate", options.rotate,
                  "Go on in a next file, FILE.2, after this size (k, M, G) or time (s, min, h, d)")
      .check(check, "SIZE|TIME")
      .needs(write);
}

lines::Rotation rotation_of(const WriteOptions& options) {
  const Quantity after = parse_quantity(options.rotate).value_or(Quantity{});
  return {after.bytes, std::chrono::seconds(after.seconds)};
}

void check_write(const WriteOptions& options, const std::vector<std::string>& inputs, bool grows) {
  if (options.path.empty()) return;
  keep_apart("--write", options.path, inputs);
  if (text::packing_of_name(options.path) != text::Packing::kNone) {
    throw UsageError("--write", options.path +
                                    ": captures that grow are not compressed; 'rubric "
                                    "convert' does it afterwards");
  }
  std::error_code none;
  const std::filesystem::path path(options.path);
  if (grows && !options.force && std::filesystem::is_regular_file(path, none)) {
    throw UsageError("--write", options.path + " exists; --force replaces it");
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::exists(path, none) && ::access(folder.c_str(), W_OK | X_OK) != 0) {
    text::print(stderr, "rubric: cannot write {}: {}\n", options.path, std::strerror(errno));
    exit_with(kExitOutput);
  }
}

}  // namespace rubric::cli
