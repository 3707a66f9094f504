// Lines of a file or of stdin, one at a time, in bounded memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace rubric::record {

class Lines {
 public:
  /// More than any frame's line; what is longer is no line of ours.
  static constexpr std::size_t kMaxBytes = 16 * 1024 * 1024;

  /// Called before each read from the file, which may wait: for work to be done meanwhile. False:
  /// nothing more is read, as if the file ended.
  using BeforeRead = std::function<bool(int fd)>;

  /// Opens a file, "-" is stdin. Throws std::system_error.
  explicit Lines(const std::string& name, BeforeRead before_read = {});
  ~Lines();
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  /// The next line without its end; false at the end of the input. The view holds until the next
  /// call. Throws std::system_error where reading fails.
  bool next(std::string_view& line);

  /// Of the line that next gave, from 1.
  std::uint64_t number() const { return number_; }
  /// Whether that line was longer than kMaxBytes; it is then cut.
  bool too_long() const { return too_long_; }

 private:
  bool fill();

  int fd_;
  BeforeRead before_read_;
  std::unique_ptr<char[]> chunk_;
  std::string_view rest_;  // Of the chunk.
  std::string line_;       // A line that spans chunks.
  std::uint64_t number_ = 0;
  bool too_long_ = false;
};

}  // namespace rubric::record
