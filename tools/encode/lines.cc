#include "tools/encode/lines.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace rubric::encode {
namespace {

constexpr std::size_t kChunkBytes = 256 * 1024;

}  // namespace

Lines::Lines(const std::string& name, BeforeRead before_read)
    : fd_(name == "-" ? 0 : ::open(name.c_str(), O_RDONLY | O_CLOEXEC)),
      before_read_(std::move(before_read)),
      chunk_(std::make_unique_for_overwrite<char[]>(kChunkBytes)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category());
}

Lines::~Lines() {
  if (fd_ > 0) ::close(fd_);
}

bool Lines::fill() {
  while (true) {
    if (before_read_ && !before_read_(fd_)) return false;
    const ssize_t got = ::read(fd_, chunk_.get(), kChunkBytes);
    if (got >= 0) {
      rest_ = {chunk_.get(), static_cast<std::size_t>(got)};
      return got > 0;
    }
    if (errno != EINTR) throw std::system_error(errno, std::generic_category());
  }
}

bool Lines::next(std::string_view& line) {
  line_.clear();
  too_long_ = false;
  if (rest_.empty() && !fill()) return false;
  ++number_;
  while (true) {
    const std::size_t end = rest_.find('\n');
    const std::string_view piece = rest_.substr(0, end);
    const bool whole = end != std::string_view::npos;
    rest_.remove_prefix(whole ? end + 1 : rest_.size());
    if (whole && line_.empty()) {
      line = piece;
    } else {
      too_long_ = too_long_ || piece.size() > kMaxBytes - line_.size();
      if (!too_long_) line_ += piece;
      line = line_;
    }
    if (whole || (rest_.empty() && !fill())) break;
  }
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

}  // namespace rubric::encode
