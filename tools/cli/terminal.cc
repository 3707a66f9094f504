#include "tools/cli/terminal.h"

#include <sys/ioctl.h>

#include <algorithm>

namespace rubric::cli {
namespace {

constexpr std::size_t kColumnsMax = 120;
constexpr std::size_t kColumnsDefault = 100;

}  // namespace

std::size_t columns(std::size_t asked, int fd) {
  if (asked != 0) return asked;
  winsize size{};
  if (::ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kColumnsDefault;
  return std::min(std::max<std::size_t>(size.ws_col, kColumnsMin), kColumnsMax);
}

}  // namespace rubric::cli
