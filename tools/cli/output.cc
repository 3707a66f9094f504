#include "tools/cli/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace rubric::cli {
namespace {

// Writes all of it; 0, or the errno of what stopped it.
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

int write_new(const char* path, std::string_view text) {
  const int fd = ::open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) return errno;
  const int error = write_all(fd, text);
  // What a full disk refuses may show only here.
  return ::close(fd) != 0 && error == 0 ? errno : error;
}

}  // namespace

bool Output::flush() {
  if (open()) {
    const int error = write_all(fd_, buffer_.view());
    closed_ = error == EPIPE;
    if (!closed_) error_ = error;
  }
  buffer_.clear();
  return open();
}

bool Output::failed(std::string* what) const {
  if (error_ != 0 && what) *what = std::strerror(error_);
  return error_ != 0;
}

bool write_file(const std::string& path, std::string_view text) {
  const bool to_stdout = path == "-";
  if (to_stdout) std::fflush(stdout);  // What was printed before comes before.
  const int error = to_stdout ? write_all(STDOUT_FILENO, text) : write_new(path.c_str(), text);
  if (error == 0 || error == EPIPE) return true;
  fmt::print(stderr, "rubric: cannot write {}: {}\n", to_stdout ? "stdout" : path,
             std::strerror(error));
  return false;
}

}  // namespace rubric::cli
