// A child process behind pipes, line by line, under a watchdog. Whatever it does - dies, hangs,
// floods, closes its pipes - no call here takes longer than its deadline, and no process is left.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "codec/lines/time.h"

namespace rubric::targets {

/// All but the accessors throw runner::TargetBroken with what the process did wrong: "ended with
/// status 3", "was killed by signal 9", "gave no answer within 5000 ms". SIGPIPE is ignored in this
/// process from the first one on. Not for several threads at once. Signals that end this process
/// end its children too where end_groups_on_signals() was called.
class Process {
 public:
  static constexpr std::size_t kLineBytesMax = 65535;    ///< Not counting the line feed.
  static constexpr std::size_t kStderrBytesMax = 65536;  ///< Its last ones are kept.

  enum class Stderr : unsigned char { kTaken, kOurs };
  /// Runs `/bin/sh -c command` as the leader of a process group of its own. Its standard error is
  /// taken, for take_stderr(), or is this process's own.
  static std::unique_ptr<Process> run(const std::string& command, Stderr err = Stderr::kTaken);
  /// Runs `body` in a copy of this process, which exits with the status that it returns. Only where
  /// no other thread may hold a lock.
  static std::unique_ptr<Process> copy(const std::function<int(int in_fd, int out_fd)>& body);

  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// Kills its whole group, if it still runs, and what left the group or its session.
  ~Process();

  /// Writes all of `text`.
  void write(std::string_view text, lines::SteadyTime deadline);
  /// Returns the next line of its standard output, without the line feed.
  std::string read_line(lines::SteadyTime deadline);
  /// Returns whether it has written something that was not read.
  bool has_output();
  /// Returns whether its standard output was seen to end.
  bool closed() const { return out_fd_ < 0; }
  /// Returns the ends of its pipes for whoever reads and writes them alone; -1: closed. They do not
  /// block.
  int out_fd() const { return out_fd_; }
  int in_fd() const { return in_fd_; }
  /// Returns the end of its standard error since the last call.
  std::string take_stderr();

  /// Closes its standard input, by which it is asked to end.
  void close_input();
  /// Closes its standard input, gives it `grace` to end, and then kills it. Returns what was wrong
  /// with its end; empty if it ended by itself, silently, with status 0.
  std::string end(lines::Milliseconds grace);
  /// Ends the whole group, and waits until the process is gone. Its standard error can be taken
  /// afterwards.
  void kill();

 private:
  struct Pipe {
    int read_fd = -1;
    int write_fd = -1;
  };
  struct Pipes {
    Pipe in, out, err;
  };
  static Pipes open_pipes(Stderr err);
  static void close_pipes(Pipes& pipes);
  Process(pid_t pid, std::size_t place, Pipes pipes);

  bool wait_for_pipes(bool want_write, lines::SteadyTime deadline);
  void drain_output();
  void drain_stderr();
  bool exited(lines::Milliseconds within);
  [[noreturn]] void ended_early();

  pid_t pid_ = -1;     // -1: gone, and waited for.
  std::string mark_;   // Of its environment; empty: it has none.
  std::size_t place_;  // Place of its group, while it is not gone.
  int status_ = 0;     // Once it is gone.
  int in_fd_ = -1;     // Its standard input, written here; -1: closed.
  int out_fd_ = -1;
  int err_fd_ = -1;
  std::string output_;  // Read and not yet handed out, from out_at_ on.
  std::size_t out_at_ = 0;
  std::string stderr_;
};

}  // namespace rubric::targets
