// A file, pipe or device that is being read.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rubric::cli {

/// A followed file has changed; `what` says how.
class FileChanged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class InputFile {
 public:
  /// Opens `name`; "-" is stdin. With `follow` there may be more later at its end; `on_idle` is
  /// called while waiting for that, and outlives this. Throws std::system_error.
  InputFile(const std::string& name, bool follow, const std::function<void()>& on_idle);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  bool is_regular() const { return is_regular_; }

  /// Reads up to `size` bytes and returns their number, 0 at the end, which a followed file has
  /// only when the user asks to stop. Throws std::system_error, and, once all was read, FileChanged
  /// if the file became shorter, was overwritten, or its name belongs to another file or none.
  std::size_t read(std::uint8_t* to, std::size_t size);

  /// Returns whether more bytes are there, or will be in a moment.
  bool has_more_soon() const;

 private:
  off_t left() const;
  bool still_has_tail(std::size_t got) const;
  void wait();
  bool ready() const;

  std::string name_;
  int fd_;
  bool is_stdin_;
  bool is_regular_ = false;
  bool follow_;
  std::vector<std::uint8_t> tail_;  // Of a followed file: the last bytes that were read.
  const std::function<void()>& on_idle_;
};

}  // namespace rubric::cli
