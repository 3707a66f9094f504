// A file, pipe or device that is being read.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "codec/text/packed.h"

namespace rubric::cli {

/// A followed file has changed; `what` says how.
class FileChanged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The most bytes that beginning_of() returns.
inline constexpr std::size_t kBeginningMost = 256 * 1024;

/// Returns what a file begins with, or what comes first on stdin, where the next InputFile still
/// finds it. Of other pipes and devices nothing is taken. Throws std::system_error.
std::vector<std::uint8_t> beginning_of(const std::string& name);

class InputFile {
 public:
  /// Opens `name`; "-" is stdin. With `follow` there may be more later at its end; `on_idle` is
  /// called while waiting for that, and outlives this. Throws std::system_error.
  InputFile(const std::string& name, bool follow, const std::function<void()>& on_idle);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  bool is_regular() const { return is_regular_; }
  /// Returns whether the bytes that were read so far are unpacked ones.
  bool is_packed() const { return unpacker_ != nullptr; }

  /// Reads up to `size` bytes and returns their number, 0 at the end, which a followed file has
  /// only when the user asks to stop. Unpacks what begins as gzip or zstd data, up to the first
  /// damage. Throws std::system_error, and, once all was read, FileChanged if the file became
  /// shorter, was overwritten, or its name belongs to another file or none.
  std::size_t read(std::uint8_t* to, std::size_t size);

  /// Returns what is wrong with the packed bytes, and where; empty if nothing was found.
  std::string damage() const;

  /// Returns whether more bytes are there, or will be in a moment.
  bool has_more_soon() const;

  /// Does the same without unpacking.
  std::size_t read_plain(std::uint8_t* to, std::size_t size);

 private:
  std::size_t read_packed(std::uint8_t* to, std::size_t size);
  off_t left() const;
  bool still_has_tail(std::size_t got) const;
  void wait();
  bool ready() const;

  std::string name_;
  int fd_;
  bool is_stdin_;
  bool is_regular_ = false;
  bool follow_;
  bool begun_ = false;
  std::unique_ptr<text::Unpacker> unpacker_;  // Null: the bytes are as they are.
  std::vector<std::uint8_t> packed_;          // Read, and from packed_at_ on not unpacked.
  std::size_t packed_at_ = 0;
  std::uint64_t packed_before_ = 0;  // Bytes of the file before those of packed_.
  std::string damage_;
  std::vector<std::uint8_t> tail_;  // Of a followed file: the last bytes that were read.
  const std::function<void()>& on_idle_;
};

}  // namespace rubric::cli
