#include "tools/cli/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <thread>
#include <utility>

#include "codec/lines/stop.h"
#include "tools/cli/terminal.h"

namespace rubric::cli {
namespace {

constexpr std::size_t kPackedBytes = 64 * 1024;
constexpr std::size_t kTailBytes = 256;  // A frame, or most of one.
constexpr int kDetectPatienceMs = 200;
constexpr std::chrono::milliseconds kFollowEvery{100};

// Opens without waiting: ready() waits for the writer of a named pipe, where the user can stop it,
// and open() does not.
int open_at_once(const std::string& name) {
  const int fd = ::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd >= 0) ::fcntl(fd, F_SETFL, O_RDONLY);
  return fd;
}

// What beginning_of() has read from stdin, until an InputFile takes it.
std::vector<std::uint8_t>& stdin_ahead() {
  static std::vector<std::uint8_t> bytes;
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> beginning_of(const std::string& name) {
  const std::function<void()> no_idling;
  InputFile file(name, false, no_idling);
  if (name != "-" && !file.is_regular()) return {};
  std::vector<std::uint8_t> bytes(kBeginningMost);
  bytes.resize(file.read_plain(bytes.data(), bytes.size()));
  if (name == "-") stdin_ahead() = bytes;
  return bytes;
}

InputFile::InputFile(const std::string& name, bool follow, const std::function<void()>& on_idle)
    : name_(name),
      fd_(name == "-" ? 0 : open_at_once(name)),
      is_stdin_(name == "-"),
      follow_(follow),
      on_idle_(on_idle) {
  if (is_stdin_) say_what_is_awaited();
  if (fd_ < 0) throw std::system_error(errno, std::generic_category());
  struct stat status {};
  if (::fstat(fd_, &status) == 0) is_regular_ = S_ISREG(status.st_mode);
}

InputFile::~InputFile() {
  if (!is_stdin_) ::close(fd_);
}

std::size_t InputFile::read(std::uint8_t* to, std::size_t size) {
  if (unpacker_) return read_packed(to, size);
  const std::size_t got = read_plain(to, size);
  if (std::exchange(begun_, true)) return got;
  unpacker_ = text::make_unpacker(text::packing_of(Bytes(to, got)));
  if (!unpacker_) return got;
  if (follow_) throw FileChanged("it is compressed, so that nothing can follow");
  packed_.assign(to, to + got);
  return read_packed(to, size);
}

std::size_t InputFile::read_packed(std::uint8_t* to, std::size_t size) {
  while (damage_.empty()) {
    const Bytes all(packed_.data(), packed_.size());
    Bytes rest = all.from(packed_at_);
    std::size_t got = 0;
    try {
      got = unpacker_->unpack(rest, {to, size});
    } catch (const text::PackedDamage& damage) {
      damage_ = damage.what();
    }
    packed_at_ = all.size() - rest.size();
    if (got != 0) return got;
    if (!damage_.empty()) break;
    packed_before_ += packed_.size();
    packed_.resize(kPackedBytes);
    packed_.resize(read_plain(packed_.data(), packed_.size()));
    packed_at_ = 0;
    if (!packed_.empty()) continue;
    if (unpacker_->may_end()) return 0;
    damage_ = "its compressed data end too soon";
  }
  return 0;
}

std::string InputFile::damage() const {
  if (damage_.empty()) return {};
  return fmt::format("damaged at byte {}: {}", packed_before_ + packed_at_, damage_);
}

std::size_t InputFile::read_plain(std::uint8_t* to, std::size_t size) {
  std::vector<std::uint8_t>& ahead = stdin_ahead();
  if (is_stdin_ && !ahead.empty()) {
    const std::size_t got = std::min(size, ahead.size());
    std::copy_n(ahead.begin(), got, to);
    ahead.erase(ahead.begin(), ahead.begin() + static_cast<std::ptrdiff_t>(got));
    return got;
  }
  while (true) {
    if (!ready()) return 0;
    const ssize_t got = ::read(fd_, to, size);
    if (got > 0) {
      const auto count = static_cast<std::size_t>(got);
      if (!follow_ || !is_regular_) return count;
      if (!still_has_tail(count)) throw FileChanged("it was overwritten");
      tail_.assign(to + (count - std::min(count, kTailBytes)), to + count);
      return count;
    }
    if (got < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category());
    // Another writer may open a named pipe; what ends on stdin has ended.
    const bool ended = got == 0 && (!follow_ || (is_stdin_ && !is_regular_));
    if (lines::stop_requested() || ended) return 0;
    if (got == 0) wait();
  }
}

// Returns whether what was read before these `got` bytes is still in the file.
bool InputFile::still_has_tail(std::size_t got) const {
  std::vector<std::uint8_t> now(tail_.size());
  const off_t at = ::lseek(fd_, 0, SEEK_CUR) - static_cast<off_t>(got + tail_.size());
  return ::pread(fd_, now.data(), now.size(), at) == static_cast<ssize_t>(now.size()) &&
         now == tail_;
}

bool InputFile::has_more_soon() const {
  if (is_stdin_ && !stdin_ahead().empty()) return true;
  if (unpacker_ && packed_at_ < packed_.size()) return true;
  if (is_regular_) return !follow_ || left() > 0;
  pollfd wait{fd_, POLLIN, 0};
  return ::poll(&wait, 1, kDetectPatienceMs) > 0 && (wait.revents & POLLIN) != 0;
}

off_t InputFile::left() const {
  struct stat status {};
  return ::fstat(fd_, &status) == 0 ? status.st_size - ::lseek(fd_, 0, SEEK_CUR) : 0;
}

// Waits. Returns false when the user asks to stop. One of several threads has no signals to end its
// waiting.
bool InputFile::ready() const {
  pollfd one{fd_, POLLIN, 0};
  while (!is_regular_) {
    if (lines::stop_requested()) return false;
    if (::poll(&one, 1, static_cast<int>(kFollowEvery.count())) != 0) break;
  }
  return true;
}

void InputFile::wait() {
  if (is_regular_ && left() < 0) throw FileChanged("it has become shorter");
  if (is_regular_ && !is_stdin_ && left() == 0) {
    struct stat ours {};
    struct stat named {};
    if (::stat(name_.c_str(), &named) != 0) throw FileChanged("it was renamed or deleted");
    const bool same =
        ::fstat(fd_, &ours) == 0 && ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
    if (!same) throw FileChanged("another file has taken its name");
    if (!still_has_tail(0)) throw FileChanged("it was overwritten");
  }
  if (on_idle_) on_idle_();
  std::this_thread::sleep_for(kFollowEvery);
}

}  // namespace rubric::cli
