#include "tools/cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "codec/text/files.h"

namespace rubric::cli {
bool Output::flush() {
  if (open()) {
    const int error = report::write_all(fd_, buffer_.view());
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
  if (to_stdout) std::fflush(stdout);  // Keeps the order with earlier output.
  const int error =
      to_stdout ? report::write_all(STDOUT_FILENO, text) : report::write_file(path, text);
  if (error == 0 || error == EPIPE) return true;
  fmt::print(stderr, "rubric: cannot write {}: {}\n", to_stdout ? "stdout" : path,
             std::strerror(error));
  return false;
}

}  // namespace rubric::cli
