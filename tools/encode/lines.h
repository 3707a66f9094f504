// Reads lines of a file or of stdin, one at a time, in bounded memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace rubric::encode {

class Lines {
 public:
  /// More than any frame's line; longer lines cannot be valid.
  static constexpr std::size_t kMaxBytes = 16 * 1024 * 1024;

  /// Called before each read from the file, which may wait, to do other work meanwhile. Returns
  /// false to stop reading, as if the file ended.
  using BeforeRead = std::function<bool(int fd)>;

  /// Opens a file, "-" is stdin. Throws std::system_error.
  explicit Lines(const std::string& name, BeforeRead before_read = {});
  ~Lines();
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  /// Reads the next line without its end; returns false at the end of the input. The view is valid
  /// until the next call. Throws std::system_error if reading fails.
  bool next(std::string_view& line);

  /// Returns the number of that line, from 1.
  std::uint64_t number() const { return number_; }
  /// Returns whether that line was longer than kMaxBytes; it is then cut.
  bool too_long() const { return too_long_; }

 private:
  bool fill();

  int fd_;
  BeforeRead before_read_;
  std::unique_ptr<char[]> chunk_;
  std::string_view rest_;  // Rest of the chunk.
  std::string line_;       // A line that spans chunks.
  std::uint64_t number_ = 0;
  bool too_long_ = false;
};

}  // namespace rubric::encode
