// rubric: the command line. A subcommand is one file, which adds itself.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <new>
#include <string_view>

#include "tools/commands/commands.h"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 clean, 1 something was found, 2 the kit or an implementation broke, 3 nothing "
    "was\n"
    "decided or not all was done, 64 usage, 66 input cannot be read, 74 output cannot be written.\n"
    "'rubric COMMAND --help' says more.";

struct Entry {
  std::string_view name;
  void (*add)(rubric::cli::Command& program);
};
// In the order of the help.
constexpr Entry kCommands[] = {
    {"decode", rubric::tools::add_decode},
    {"encode", rubric::tools::add_encode},
    {"convert", rubric::tools::add_convert},
    {"stats", rubric::tools::add_stats},
    {"explain", rubric::tools::add_explain},
    {"messages", rubric::tools::add_messages},
    {"send", rubric::tools::add_send},
    {"forward", rubric::tools::add_forward},
    {"install-wireshark", rubric::tools::add_install_wireshark},
    {"check", rubric::tools::add_check},
    {"test", rubric::tools::add_test},
    {"new-adapter", rubric::tools::add_new_adapter},
    {"new-protocol", rubric::tools::add_new_protocol},
    {"shrink", rubric::tools::add_shrink},
    {"diff", rubric::tools::add_diff},
    {"chart", rubric::tools::add_chart},
    {"run", rubric::tools::add_run},
    {"monitor", rubric::tools::add_monitor},
    {"simulate", rubric::tools::add_simulate},
    {"explore", rubric::tools::add_explore},
    {"coverage", rubric::tools::add_coverage},
    {"generate", rubric::tools::add_generate},
    {"repro", rubric::tools::add_repro},
    {"completion", rubric::tools::add_completion},
};

std::atomic<bool> without_memory = false;

[[noreturn]] void note_no_memory() {
  without_memory = true;
  throw std::bad_alloc();
}

// Called where an exception may not leave a function, as in the library of the command line.
[[noreturn]] void give_up() {
  if (!without_memory) std::abort();
  constexpr std::string_view kWhy = "rubric: out of memory\n";
  const ssize_t written = ::write(STDERR_FILENO, kWhy.data(), kWhy.size());
  ::_exit(written < 0 ? rubric::cli::kExitOutput : rubric::cli::kExitBroken);
}

// A file that is opened must not take the place of a standard stream that is closed. Reads of stdin
// and writes to the others go on to fail.
void hold_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (::fcntl(fd, F_GETFD) >= 0) continue;
    if (::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) != fd)
      ::_exit(rubric::cli::kExitBroken);
  }
}

bool reader_is_gone() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

int run(int argc, char** argv) {
  rubric::cli::Command program{
      "rubric", "Codec and conformance test kit for the RUBICON Communication Layer."};
  program.version(RUBRIC_VERSION);
  program.footer(kFooter);
  // To make the options of all takes longer than to decode a frame.
  const std::string_view first = argc > 1 ? argv[1] : "";
  const bool alone = first != "completion" &&
                     std::ranges::find(kCommands, first, &Entry::name) != std::end(kCommands);
  for (const Entry& command : kCommands) {
    if (!alone || command.name == first) command.add(program);
  }
  const int code = program.parse_and_run(argc, argv);
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  if (errno != 0 && errno != EPIPE) {
    std::perror("rubric: cannot write stdout");
  } else if (errno == 0 && code == rubric::cli::kExitClean && !reader_is_gone()) {
    std::fputs("rubric: cannot write stdout\n", stderr);  // It failed before, as long help does.
  }
  return rubric::cli::kExitOutput;
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  // A closed pipe shows as a failed write, which ends the output without a word.
  std::signal(SIGPIPE, SIG_IGN);
  std::set_new_handler(note_no_memory);
  std::set_terminate(give_up);
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {  // There is no memory even for the options.
    std::fprintf(stderr, "rubric: %s\n", error.what());
    return rubric::cli::kExitBroken;
  }
}
