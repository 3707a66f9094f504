#include "tools/cli/color.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace rubric::cli {

void add_color_option(Command& app, std::string& when) {
  app.add_option("--color", when, "Colour the text: auto (on a terminal), always or never")
      .one_of({"auto", "always", "never"});
}

bool use_color(const std::string& when, int fd) {
  if (when == "always") return true;
  if (when == "never") return false;
  const char* no_color = std::getenv("NO_COLOR");
  if (no_color && *no_color) return false;
  const char* term = std::getenv("TERM");
  if (term && std::string_view(term) == "dumb") return false;
  return isatty(fd) == 1;
}

}  // namespace rubric::cli
