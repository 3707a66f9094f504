#include "tools/commands/run/line_output.h"

#include <limits.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

#include "codec/text/text.h"

namespace rubric::run {
namespace {

constexpr std::size_t kWaitingMax = 4 << 20;

}  // namespace

// The descriptor may be shared and block. A pipe or terminal that can be written takes so much.
bool LineOutput::write_some() {
  std::size_t done = 0;
  while (error_ == 0 && done < waiting_.size()) {
    pollfd output{fd_, POLLOUT, 0};
    if (::poll(&output, 1, 0) <= 0) break;
    const std::size_t size = std::min<std::size_t>(waiting_.size() - done, PIPE_BUF);
    const ssize_t written = ::write(fd_, waiting_.data() + done, size);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR && errno != EAGAIN) {
      error_ = errno;
    } else if (errno == EAGAIN) {
      break;
    }
  }
  waiting_.erase(0, done);
  return error_ != 0 || waiting_.empty();
}

void LineOutput::put(std::string_view line) {
  const std::lock_guard lock(mutex_);
  if (error_ != 0) return;
  if (waiting_.size() + line.size() > kWaitingMax) {
    if (lost_++ == 0) {
      text::print(stderr, "rubric: {}: its reader is too slow: events are lost\n", name_);
    }
    return;
  }
  waiting_ += line;
  write_some();
}

bool LineOutput::flush() {
  const std::lock_guard lock(mutex_);
  return write_some();
}

void LineOutput::finish(lines::SteadyTime deadline) {
  const std::lock_guard lock(mutex_);
  while (!write_some()) {
    const auto left =
        std::chrono::ceil<lines::Milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) break;
    pollfd output{fd_, POLLOUT, 0};
    ::poll(&output, 1, static_cast<int>(left.count()));
  }
  if (error_ == 0)
    lost_ += static_cast<std::size_t>(std::count(waiting_.begin(), waiting_.end(), '\n'));
  waiting_.clear();
  if (lost_ != 0) text::print(stderr, "rubric: {}: {} events were lost\n", name_, lost_);
  lost_ = 0;
}

int LineOutput::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace rubric::run
