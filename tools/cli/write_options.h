// The options of captures that commands keep of what they read.
#pragma once

#include <string>
#include <vector>

#include "codec/lines/capture_file.h"
#include "tools/cli/command.h"

namespace rubric::cli {

/// Filled by add_write_options.
struct WriteOptions {
  std::string path;  ///< Empty: no capture is kept.
  bool force = false;
  std::string rotate;

  /// Returns how a capture of a source that goes on is written.
  lines::CaptureFile::Mode growing() const {
    return force ? lines::CaptureFile::Mode::kGrowOver : lines::CaptureFile::Mode::kGrow;
  }
};

/// Adds --write with this description, --force and, with `rotates`, --rotate. `with_log`: --force
/// is also for a --log of the command, which checks that one of them is given.
void add_write_options(Command& command, WriteOptions& options, const std::string& description,
                       bool rotates, bool with_log = false);
/// Returns what --rotate says.
lines::Rotation rotation_of(const WriteOptions& options);
/// Throws UsageError if an option's file is there and the command does not replace it. Ends the
/// command if its folder cannot be written.
void check_place(const std::string& option, const std::string& path, bool replaces);
/// Throws UsageError if the capture would replace one of the `inputs`, or would grow in place of
/// a file without --force. Ends the command if its folder cannot be written.
void check_write(const WriteOptions& options, const std::vector<std::string>& inputs, bool grows);

}  // namespace rubric::cli
