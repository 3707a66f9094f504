#include "codec/lines/capture_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace rubric::lines {
namespace {

constexpr std::size_t kEnough = 64 * 1024;

}  // namespace

CaptureFile::CaptureFile(const std::string& path)
    : path_(path), fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), path);
  writer_.begin(waiting_);
  flush();  // Readers of the growing file see what it is.
}

CaptureFile::~CaptureFile() { ::close(fd_); }

void CaptureFile::write(const Packet& packet, std::string_view interface_name) {
  writer_.write(packet, interface_name, waiting_);
  if (waiting_.size() >= kEnough) flush();
}

void CaptureFile::flush() {
  std::size_t sent = 0;
  while (error_ == 0 && sent < waiting_.size()) {
    const ssize_t count = ::write(fd_, waiting_.data() + sent, waiting_.size() - sent);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      error_ = errno;
      if (error_ != EPIPE) complain();
    }
  }
  waiting_.clear();
}

bool CaptureFile::reader_gone() const {
  pollfd self{fd_, 0, 0};
  return error_ == EPIPE || (::poll(&self, 1, 0) == 1 && (self.revents & POLLERR) != 0);
}

bool CaptureFile::finish() {
  writer_.finish(waiting_);
  flush();
  if (error_ == 0) return true;
  if (error_ == EPIPE) complain();
  return false;
}

void CaptureFile::complain() const {
  fmt::print(stderr, "rubric: {}: {}\n", path_, std::strerror(error_));
}

}  // namespace rubric::lines
