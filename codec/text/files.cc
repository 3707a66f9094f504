#include "codec/text/files.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace rubric::text {

int read_file(const std::string& path, std::string& text) {
  text.clear();
  const bool is_stdin = path == "-";
  std::FILE* const file = is_stdin ? stdin : std::fopen(path.c_str(), "rb");
  if (!file) return errno;
  char chunk[65536];
  for (std::size_t n = 1; n != 0 && text.size() <= kTextBytesMax;) {
    n = std::fread(chunk, 1, sizeof chunk, file);
    text.append(chunk, n);
  }
  const int error = std::ferror(file) != 0 ? errno : 0;
  if (!is_stdin) std::fclose(file);
  return error == 0 && text.size() > kTextBytesMax ? EFBIG : error;
}

int write_all(int fd, std::string_view rest) {
  while (!rest.empty()) {
    const ssize_t written = ::write(fd, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {
      pollfd wait{fd, POLLOUT, 0};
      ::poll(&wait, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

OutFile::OutFile(const std::string& path, Mode mode) : path_(path) {
  struct stat old {};
  const bool exists = path != "-" && ::stat(path.c_str(), &old) == 0;
  if (path == "-") {
    fd_ = STDOUT_FILENO;
  } else if (exists && !S_ISREG(old.st_mode)) {
    fd_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else if (mode == Mode::kWhole) {
    open_beside();
    // Root keeps the owner of a user's file; others cannot, and need not.
    if (fd_ >= 0 && exists && ::fchown(fd_, old.st_uid, old.st_gid) == 0) {
      ::fchmod(fd_, old.st_mode & 0777);
    }
  } else {
    const int what = mode == Mode::kGrow ? O_EXCL : O_TRUNC;
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | what, 0666);
  }
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), path);
}

// A link stays a link: what it leads to is replaced.
void OutFile::open_beside() {
  std::error_code error;
  std::filesystem::path real = std::filesystem::weakly_canonical(path_, error);
  constexpr int kLinksMax = 40;  // As many as the kernel follows.
  for (int i = 0; i < kLinksMax && !error && std::filesystem::is_symlink(real); ++i) {
    const std::filesystem::path to = std::filesystem::read_symlink(real, error);  // To nothing yet.
    if (!error) real = std::filesystem::weakly_canonical(real.parent_path() / to, error);
  }
  if (!error) path_ = real.string();
  const std::filesystem::path path(path_);
  const std::string stem = "." + path.filename().string() + "." + std::to_string(::getpid()) + ".";
  for (int i = 0; fd_ < 0 && (i == 0 || errno == EEXIST); ++i) {
    beside_ = (path.parent_path() / (stem + std::to_string(i))).string();
    fd_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
}

OutFile::~OutFile() {
  if (fd_ > STDERR_FILENO) ::close(fd_);
  if (!beside_.empty()) ::unlink(beside_.c_str());
}

int OutFile::finish() {
  if (fd_ <= STDERR_FILENO) return 0;
  // A full disk may show only here.
  int error = !beside_.empty() && ::fsync(fd_) != 0 ? errno : 0;
  struct stat is {};
  // What somebody has deleted meanwhile went nowhere.
  const bool gone = ::fstat(fd_, &is) == 0 && S_ISREG(is.st_mode) && is.st_nlink == 0;
  if (error == 0 && gone) error = ENOENT;
  if (::close(fd_) != 0 && error == 0) error = errno;
  fd_ = -1;
  if (error != 0 || beside_.empty()) return error;
  if (::rename(beside_.c_str(), path_.c_str()) != 0) return errno;
  beside_.clear();
  return 0;
}

int write_file(const std::string& path, std::string_view text) {
  try {
    OutFile file(path, OutFile::Mode::kWhole);
    const int error = write_all(file.fd(), text);
    return error != 0 ? error : file.finish();
  } catch (const std::system_error& error) {
    return error.code().value();
  }
}

}  // namespace rubric::text
