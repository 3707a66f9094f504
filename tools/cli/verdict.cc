#include "tools/cli/verdict.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>

#include "codec/text/text.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/text_file.h"

namespace rubric::cli {

void set_verdict(Command& command, std::function<int()> run) {
  command.exit_code_of([name = command.name(), run = std::move(run)] {
    try {
      return run();
    } catch (const Ending&) {
      throw;
    } catch (const std::exception& error) {
      text::print(stderr, "rubric {}: {}\n", name, error.what());
      return int{kExitBroken};
    }
  });
}

void unreadable(const std::string& what) {
  text::print_harmless(stderr,
                       "rubric: " + (what.ends_with('\n') ? what : text::harmless(what) + '\n'));
  exit_with(kExitInput);
}

void require_file(const std::string& path) {
  if (::access(path.c_str(), R_OK) != 0) unreadable(path + ": " + std::strerror(errno));
}

std::string text_of_file(const std::string& path) {
  std::string out;
  std::string error;
  if (!read_file(path, out, error)) unreadable(error);
  return out;
}

}  // namespace rubric::cli
