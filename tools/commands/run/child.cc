#include "tools/commands/run/child.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

extern char** environ;

namespace rubric::run {
namespace {

constexpr std::chrono::milliseconds kLook{20};
constexpr int kLooks = 100;

void check(int error, const std::string& command) {
  if (error != 0) throw std::system_error(error, std::generic_category(), command);
}

}  // namespace

Child::Child(const std::string& command) {
  int input[2];
  int output[2];
  check(::pipe2(input, O_CLOEXEC) == 0 ? 0 : errno, command);
  check(::pipe2(output, O_CLOEXEC) == 0 ? 0 : errno, command);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, output[1], STDOUT_FILENO);
  // A group of its own: Ctrl-C is for the nodes, which end their applications.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  std::string text = command;
  char shell[] = "sh";
  char option[] = "-c";
  char* const arguments[] = {shell, option, text.data(), nullptr};
  const int error = ::posix_spawn(&pid_, "/bin/sh", &files, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  ::close(input[0]);
  ::close(output[1]);
  in_ = input[1];
  out_ = output[0];
  check(error, command);
}

Child::~Child() {
  ::close(in_);
  ::close(out_);
  if (pid_ < 0) return;
  for (int i = 0; i < kLooks; ++i) {
    if (::waitpid(pid_, nullptr, WNOHANG) != 0) return;
    std::this_thread::sleep_for(kLook);
  }
  ::kill(-pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

}  // namespace rubric::run
