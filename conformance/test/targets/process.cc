#include "conformance/test/targets/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "conformance/test/runner/target.h"
#include "conformance/test/targets/groups.h"
#include "conformance/test/targets/orphans.h"

namespace rubric::targets {
namespace {

using runner::TargetBroken;
using std::chrono::steady_clock;

constexpr std::size_t kReadBytes = 65536;
constexpr lines::Milliseconds kDeathWait{300};  // From a closed pipe to the end of its process.
constexpr lines::Milliseconds kTermWait{100};  // For an orderly end of what is not needed any more.
constexpr lines::Milliseconds kPause{1};
constexpr int kShellFindsNone = 127;
constexpr int kShellSignals = 128;  // A shell adds this to the signal that ended its child.

void ignore_broken_pipes() {
  static const bool done = [] {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    return ::sigaction(SIGPIPE, &ignore, nullptr) == 0;
  }();
  (void)done;
}

void close_fd(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

void do_not_block(int fd) { ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK); }

[[noreturn]] void cannot_start(int error) {
  throw TargetBroken(fmt::format("cannot be started: {}", std::strerror(error)));
}

int ms_until(lines::SteadyTime deadline) {
  const auto left = std::chrono::ceil<lines::Milliseconds>(deadline - steady_clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
}

std::string status_text(int status) {
  if (WIFSIGNALED(status)) {
    return fmt::format("was killed by signal {} ({})", WTERMSIG(status),
                       ::strsignal(WTERMSIG(status)));
  }
  const int code = WEXITSTATUS(status);
  if (code == kShellFindsNone) {
    return fmt::format("ended with status {} (as of a shell that finds no such command)", code);
  }
  if (code <= kShellSignals || code > kShellSignals + 64) {
    return fmt::format("ended with status {}", code);
  }
  return fmt::format("ended with status {} (as of signal {}, {}, behind a shell)", code,
                     code - kShellSignals, ::strsignal(code - kShellSignals));
}

}  // namespace

Process::Pipes Process::open_pipes(Stderr err) {
  ignore_broken_pipes();
  Pipes pipes;
  for (Pipe* pipe : {&pipes.in, &pipes.out, &pipes.err}) {
    if (pipe == &pipes.err && err == Stderr::kOurs) break;
    int fds[2];
    if (::pipe2(fds, O_CLOEXEC) != 0) {
      const int error = errno;
      close_pipes(pipes);
      cannot_start(error);
    }
    *pipe = {fds[0], fds[1]};
  }
  return pipes;
}

void Process::close_pipes(Pipes& pipes) {
  for (Pipe* pipe : {&pipes.in, &pipes.out, &pipes.err}) {
    close_fd(pipe->read_fd);
    close_fd(pipe->write_fd);
  }
}

std::unique_ptr<Process> Process::run(const std::string& command, Stderr err) {
  GroupStart start;
  Pipes pipes = open_pipes(err);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, pipes.in.read_fd, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, pipes.out.write_fd, STDOUT_FILENO);
  if (err == Stderr::kTaken) {
    ::posix_spawn_file_actions_adddup2(&files, pipes.err.write_fd, STDERR_FILENO);
  }
  posix_spawnattr_t how;
  ::posix_spawnattr_init(&how);
  sigset_t none;
  sigset_t usual;
  ::sigemptyset(&none);
  ::sigemptyset(&usual);
  ::sigaddset(&usual, SIGPIPE);
  ::posix_spawnattr_setflags(
      &how, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  ::posix_spawnattr_setpgroup(&how, 0);
  ::posix_spawnattr_setsigmask(&how, &none);
  ::posix_spawnattr_setsigdefault(&how, &usual);
  std::string shell = "sh";
  std::string option = "-c";
  std::string text = command;
  char* const words[] = {shell.data(), option.data(), text.data(), nullptr};
  MarkedEnvironment environment;
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, "/bin/sh", &files, &how, words, environment.get());
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&how);
  if (error != 0) {
    close_pipes(pipes);
    cannot_start(error);
  }
  std::unique_ptr<Process> out(new Process(pid, start.started(pid), pipes));
  out->mark_ = environment.mark();
  return out;
}

std::unique_ptr<Process> Process::copy(const std::function<int(int, int)>& body) {
  GroupStart start;
  Pipes pipes = open_pipes(Stderr::kTaken);
  const pid_t pid = ::fork();
  if (pid < 0) {
    const int error = errno;
    close_pipes(pipes);
    cannot_start(error);
  }
  if (pid == 0) {
    ::setpgid(0, 0);
    start.in_child();
    ::dup2(pipes.err.write_fd, STDERR_FILENO);
    close_fd(pipes.in.write_fd);
    close_fd(pipes.out.read_fd);
    close_fd(pipes.err.read_fd);
    ::_exit(body(pipes.in.read_fd, pipes.out.write_fd));
  }
  ::setpgid(pid, pid);  // In parent and child: it must be so before it is killed.
  return std::unique_ptr<Process>(new Process(pid, start.started(pid), pipes));
}

Process::Process(pid_t pid, std::size_t place, Pipes pipes)
    : pid_(pid),
      place_(place),
      in_fd_(pipes.in.write_fd),
      out_fd_(pipes.out.read_fd),
      err_fd_(pipes.err.read_fd) {
  close_fd(pipes.in.read_fd);
  close_fd(pipes.out.write_fd);
  close_fd(pipes.err.write_fd);
  for (const int fd : {in_fd_, out_fd_, err_fd_}) {
    if (fd >= 0) do_not_block(fd);
  }
}

Process::~Process() { kill(); }

void Process::write(std::string_view text, lines::SteadyTime deadline) {
  while (!text.empty()) {
    if (in_fd_ < 0) throw TargetBroken("its standard input is closed");
    const ssize_t count = ::write(in_fd_, text.data(), text.size());
    if (count > 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (count < 0 && errno == EPIPE) {
      ended_early();
    } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
      throw TargetBroken(fmt::format("cannot be written to: {}", std::strerror(errno)));
    } else if (!wait_for_pipes(true, deadline)) {
      throw TargetBroken("does not read its standard input");
    }
  }
}

std::string Process::read_line(lines::SteadyTime deadline) {
  std::size_t searched = out_at_;
  while (true) {
    const std::size_t end = output_.find('\n', searched);
    const std::size_t size = std::min(end, output_.size()) - out_at_;
    if (size > kLineBytesMax) {
      throw TargetBroken(fmt::format("wrote a line of more than {} bytes", kLineBytesMax));
    }
    if (end != std::string::npos) {
      std::string line = output_.substr(out_at_, size);
      out_at_ = end + 1;
      if (out_at_ == output_.size()) {
        output_.clear();
        out_at_ = 0;
      }
      return line;
    }
    searched = output_.size();
    if (out_fd_ < 0) ended_early();
    if (!wait_for_pipes(false, deadline)) {
      throw TargetBroken(size == 0 ? "gave no answer in time"
                                   : fmt::format("did not end its line of {} bytes in time", size));
    }
    if (out_at_ > 0) {  // Lines already returned need not be kept.
      output_.erase(0, out_at_);
      searched -= out_at_;
      out_at_ = 0;
    }
    drain_output();
  }
}

bool Process::has_output() {
  if (out_at_ == output_.size()) drain_output();
  return out_at_ < output_.size();
}

std::string Process::take_stderr() {
  drain_stderr();
  return std::exchange(stderr_, {});
}

// Waits for its output, or for room in its input; reads its standard error meanwhile. Returns false
// when the time is over.
bool Process::wait_for_pipes(bool want_write, lines::SteadyTime deadline) {
  while (true) {
    pollfd fds[] = {{want_write ? -1 : out_fd_, POLLIN, 0},
                    {want_write ? in_fd_ : -1, POLLOUT, 0},
                    {err_fd_, POLLIN, 0}};
    const int left_ms = ms_until(deadline);
    const int ready = ::poll(fds, std::size(fds), left_ms);
    if (ready < 0 && errno != EINTR) {
      throw TargetBroken(fmt::format("cannot be waited for: {}", std::strerror(errno)));
    }
    if (ready > 0 && fds[2].revents != 0) drain_stderr();
    if (ready > 0 && (fds[0].revents != 0 || fds[1].revents != 0)) return true;
    if (left_ms == 0) return false;
  }
}

// Reads a bounded piece of the output at hand.
void Process::drain_output() {
  if (out_fd_ < 0) return;
  const std::size_t before = output_.size();
  output_.resize(before + kReadBytes);
  const ssize_t count = ::read(out_fd_, output_.data() + before, kReadBytes);
  output_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) close_fd(out_fd_);
}

void Process::drain_stderr() {
  char bytes[4096];
  // A bounded piece: a process that never stops writing must not hold us here.
  for (std::size_t round = 0; err_fd_ >= 0 && round < kReadBytes / sizeof bytes; ++round) {
    const ssize_t count = ::read(err_fd_, bytes, sizeof bytes);
    if (count > 0) {
      stderr_.append(bytes, static_cast<std::size_t>(count));
    } else if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
      break;
    } else {
      close_fd(err_fd_);
    }
  }
  if (stderr_.size() > kStderrBytesMax) stderr_.erase(0, stderr_.size() - kStderrBytesMax);
}

// Returns whether it ends within this time; it is not reaped, so that its group keeps its number.
bool Process::exited(lines::Milliseconds within) {
  const lines::SteadyTime deadline = steady_clock::now() + within;
  while (true) {
    siginfo_t info{};
    const int result = ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
    if (result == 0 && info.si_pid == pid_) return true;
    if (result < 0 && errno != EINTR) return true;
    drain_stderr();
    if (steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kPause);
  }
}

void Process::ended_early() {
  const std::size_t rest = output_.size() - out_at_;
  const bool gone = pid_ < 0 || exited(kDeathWait);
  kill();
  std::string text = gone ? status_text(status_) : "closed its standard output or input";
  if (rest > 0) text += fmt::format(", in the middle of a line of {} bytes", rest);
  throw TargetBroken(text);
}

void Process::close_input() { close_fd(in_fd_); }

std::string Process::end(lines::Milliseconds grace) {
  close_fd(in_fd_);
  const bool itself = pid_ < 0 || exited(grace);
  const bool spoke = has_output();
  kill();
  if (!itself) return fmt::format("did not end within {} ms", grace.count());
  if (!WIFEXITED(status_) || WEXITSTATUS(status_) != 0) return status_text(status_);
  return spoke ? "wrote something that was not asked for" : "";
}

void Process::kill() {
  close_fd(in_fd_);
  if (pid_ >= 0) {
    if (!exited(lines::Milliseconds(0))) {
      ::kill(-pid_, SIGTERM);
      exited(kTermWait);
    }
    ::kill(-pid_, SIGKILL);
    forget_group(place_);
    while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    if (!mark_.empty()) end_orphans(mark_);
    drain_stderr();
  }
  close_fd(out_fd_);
  close_fd(err_fd_);
}

}  // namespace rubric::targets
