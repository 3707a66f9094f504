#include "tools/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "codec/text/text.h"

namespace rubric::cli {
namespace {

constexpr std::size_t kColumnsMin = 60;
constexpr std::size_t kColumnsMax = 120;
constexpr std::size_t kColumnsDefault = 100;
constexpr std::size_t kRowsMin = 5;
constexpr std::size_t kRowsDefault = 24;

}  // namespace

void say_what_is_awaited() {
  static bool said = false;
  if (::isatty(STDIN_FILENO) == 0 || std::exchange(said, true)) return;
  text::print(stderr, "rubric: reads what is typed here; Ctrl-D on a line of its own ends it\n");
}

void add_width_option(Command& command, std::size_t& asked) {
  command
      .add_option("--width", asked,
                  "Wrap text at this many columns (default: the terminal's, else 100)")
      .between(kColumnsMin, std::size_t{1000});
}

std::size_t columns(std::size_t asked, int fd) {
  if (asked != 0) return asked;
  const std::size_t found = screen_columns(fd);
  return found == 0 ? kColumnsDefault : std::clamp(found, kColumnsMin, kColumnsMax);
}

std::size_t screen_columns(int fd) {
  winsize size{};
  return ::ioctl(fd, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::size_t rows(int fd) {
  winsize size{};
  if (::ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_row == 0) return kRowsDefault;
  return std::max<std::size_t>(size.ws_row, kRowsMin);
}

}  // namespace rubric::cli
