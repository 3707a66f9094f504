#include "tools/cli/output.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace rubric::cli {

bool Output::flush() {
  std::string_view rest = buffer_.view();
  while (!rest.empty() && open()) {
    const ssize_t written = ::write(fd_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EPIPE) {
      closed_ = true;
    } else if (errno == EAGAIN) {
      pollfd wait{fd_, POLLOUT, 0};
      ::poll(&wait, 1, -1);
    } else if (errno != EINTR) {
      error_ = errno;
    }
  }
  buffer_.clear();
  return open();
}

bool Output::failed(std::string* what) const {
  if (error_ != 0 && what) *what = std::strerror(error_);
  return error_ != 0;
}

}  // namespace rubric::cli
