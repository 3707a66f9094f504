// Standard output and files, through one big buffer or written whole.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "codec/text/files.h"
#include "codec/text/packed.h"
#include "tools/format/buffer.h"

namespace rubric::cli {

/// Collects in buffer() and writes in large pieces.
class Output {
 public:
  using Mode = text::OutFile::Mode;

  explicit Output(int fd = 1) : fd_(fd) {}
  /// Writes to a file, packed if its name ends in .gz or .zst; "-" is stdout. Ends the command if
  /// it cannot be opened. What was written to a kWhole file is gone unless finish() is called.
  Output(const std::string& path, Mode mode);
  ~Output() { flush(); }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  format::Buffer& buffer() { return buffer_; }
  int fd() const { return fd_; }

  /// Writes the buffer out once enough has gathered; returns false if writing has failed.
  bool drain() { return buffer_.size() < kEnough ? open() : flush(); }
  /// Writes all of it; returns false if writing has failed.
  bool flush();

  bool open() const { return error_ == 0; }
  /// Writes all of it and ends the file. Returns false if something could not be written, having
  /// printed why on stderr, except that a closed pipe is no news.
  bool finish();

 private:
  static constexpr std::size_t kEnough = 192 * 1024;

  std::unique_ptr<text::OutFile> file_;  // Null: a descriptor of somebody else.
  std::string name_ = "-";
  int fd_;
  int error_ = 0;
  std::unique_ptr<text::Packer> packer_;
  std::string packed_;
  format::Buffer buffer_;
};

/// Returns whether the error, as in errno, of writing to the file, or to stdout for "-", is 0; else
/// prints it on stderr, except that a closed pipe is no news.
bool is_written(const std::string& name, int error);

/// Writes all of `text` to the file, or to stdout for "-". Returns false if that fails, having
/// printed why on stderr, except that a closed pipe is no news.
bool write_file(const std::string& path, std::string_view text);

/// Prints which output cannot be opened, and why. Returns the exit code.
int cannot_write(const std::system_error& error);

/// Throws UsageError if writing to `output` would replace one of the `files`, by whatever name or
/// link; none of them, or "-", is stdin. An `output` of "-" is stdout, an empty one nothing.
void keep_apart(const std::string& option, const std::string& output,
                const std::vector<std::string>& files);

}  // namespace rubric::cli
