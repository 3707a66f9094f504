#include "tools/cli/terminal.h"

#include <sys/ioctl.h>

#include <algorithm>

namespace rubric::cli {
namespace {

constexpr std::size_t kColumnsMax = 120;
constexpr std::size_t kColumnsDefault = 100;
constexpr std::size_t kRowsMin = 10;
constexpr std::size_t kRowsDefault = 24;

}  // namespace

std::size_t columns(std::size_t asked, int fd) {
  if (asked != 0) return asked;
  winsize size{};
  if (::ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kColumnsDefault;
  return std::min(std::max<std::size_t>(size.ws_col, kColumnsMin), kColumnsMax);
}

std::size_t rows(int fd) {
  winsize size{};
  if (::ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_row == 0) return kRowsDefault;
  return std::max<std::size_t>(size.ws_row, kRowsMin);
}

}  // namespace rubric::cli
