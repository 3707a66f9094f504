// Standard output through one big buffer, and files written whole. A reader that closed the pipe is
// no error.
#pragma once

#include <string>
#include <string_view>

#include "tools/format/buffer.h"

namespace rubric::cli {

/// Collects in buffer() and writes to a file descriptor in large pieces.
class Output {
 public:
  explicit Output(int fd = 1) : fd_(fd) {}
  ~Output() { flush(); }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  format::Buffer& buffer() { return buffer_; }

  /// Writes the buffer out once enough has gathered; returns false if the reader is gone.
  bool drain() { return buffer_.size() < kEnough ? open() : flush(); }
  /// Writes all of it; returns false if the reader is gone.
  bool flush();

  bool open() const { return !closed_ && error_ == 0; }
  /// Returns whether writing failed for another reason than a closed pipe; `what` becomes the
  /// reason.
  bool failed(std::string* what = nullptr) const;

 private:
  static constexpr std::size_t kEnough = 192 * 1024;

  int fd_;
  int error_ = 0;
  bool closed_ = false;
  format::Buffer buffer_;
};

/// Writes all of `text` to the file, or to stdout for "-". Returns false, having printed why on
/// stderr, if that fails.
bool write_file(const std::string& path, std::string_view text);

}  // namespace rubric::cli
