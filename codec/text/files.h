// The one way in which commands read texts whole, and write files: whole beside the name, or
// growing under it.
#pragma once

#include <string>
#include <string_view>

namespace rubric::text {

/// More than any text that is held whole: a longer one would fill the memory.
inline constexpr std::size_t kTextBytesMax = 256 * 1024 * 1024;
/// Reads a whole file, or stdin for "-", into `text`. Returns 0, or the error as in errno: EFBIG if
/// it has more than kTextBytesMax bytes.
int read_file(const std::string& path, std::string& text);

/// Writes all of `text` to the file descriptor, waiting if needed. Returns 0, or the error as in
/// errno.
int write_all(int fd, std::string_view text);

/// A file that is being written. Devices and pipes are written at once, however they are opened.
class OutFile {
 public:
  enum class Mode {
    kWhole,  ///< Written beside its name, which it takes in finish(); an old file stays until then.
    kGrow,   ///< Grows under its name; an old file is refused with EEXIST.
    kGrowOver,  ///< Grows under its name, in place of an old file.
  };

  /// Opens the file; "-" is stdout. Throws std::system_error with the path.
  OutFile(const std::string& path, Mode mode);
  /// Removes what kWhole left beside the name, unless finish() was called.
  ~OutFile();
  OutFile(const OutFile&) = delete;
  OutFile& operator=(const OutFile&) = delete;

  int fd() const { return fd_; }
  /// Closes the file and, with kWhole, gives it its name. Returns 0, or the error as in errno,
  /// ENOENT if the file was deleted meanwhile; then an old file is as it was.
  int finish();

 private:
  void open_beside();

  std::string path_;
  std::string beside_;  // Empty: the file has its name already.
  int fd_ = -1;
};

/// Writes `text` as the whole of a new or an old file, or to stdout for "-". Returns 0, or the
/// error as in errno; then an old file is as it was.
int write_file(const std::string& path, std::string_view text);

}  // namespace rubric::text
