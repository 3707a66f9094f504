// A file, pipe or device that is being read.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace rubric::cli {

class InputFile {
 public:
  /// `name`: "-" is stdin. `follow`: at the end of it there may be more later; `on_idle` is called
  /// while that is waited for, and outlives this. Throws std::system_error.
  InputFile(const std::string& name, bool follow, const std::function<void()>& on_idle);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  bool is_regular() const { return is_regular_; }

  /// Up to `size` bytes, 0 at the end, which a file that is followed has only when the user asks
  /// to stop. Throws std::system_error; ESTALE where a file became shorter.
  std::size_t read(std::uint8_t* to, std::size_t size);

  /// Whether more bytes are there, or will be in a moment.
  bool has_more_soon() const;

 private:
  off_t left() const;
  void wait();

  int fd_;
  bool is_stdin_;
  bool is_regular_ = false;
  bool follow_;
  const std::function<void()>& on_idle_;
};

}  // namespace rubric::cli
