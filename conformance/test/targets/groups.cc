#include "conformance/test/targets/groups.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>

#include "conformance/test/runner/target.h"
#include "conformance/test/targets/orphans.h"

namespace rubric::targets {
namespace {

constexpr std::size_t kGroupsMax = 4096;
constexpr int kTermWaitMs = 100;  // For an orderly end, before there is another.
constexpr pid_t kFree = 0;
constexpr pid_t kTaken = -1;  // Taken by a child that is about to start.
constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

// The only data that the handler may touch.
std::array<std::atomic<pid_t>, kGroupsMax> groups{};
std::atomic<int> starting = 0;     // Children whose groups are not known yet.
std::atomic<bool> ending = false;  // The handler is at work.
static_assert(std::atomic<pid_t>::is_always_lock_free);

void sleep_ms(int ms) { ::poll(nullptr, 0, ms); }  // Handlers may call this.

// Waits for the handler to end this process: nothing may be started any more.
void wait_for_end() {
  while (ending) sleep_ms(-1);
}

bool send_to_all(int signal) {
  bool any = false;
  for (const std::atomic<pid_t>& group : groups) {
    const pid_t id = group;
    if (id > 0 && ::kill(-id, signal) == 0) any = true;
  }
  return any;
}

extern "C" void end_groups(int signal) {
  ending = true;
  while (starting > 0) sleep_ms(1);  // Never our own thread's: it has blocked the signal.
  if (send_to_all(SIGTERM)) {
    sleep_ms(kTermWaitMs);
    send_to_all(SIGKILL);
  }
  end_all_children();  // What left their sessions, too.
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  ::sigaction(signal, &usual, nullptr);
  ::raise(signal);  // Comes when we return.
}

sigset_t all_signals() {
  sigset_t out;
  ::sigemptyset(&out);
  for (const int signal : kSignals) ::sigaddset(&out, signal);
  return out;
}

// Waits for the child, passes the signals on to it, and ends as it did once all its descendants are
// gone. Kills it if `parent` is given and is gone.
[[noreturn]] void stand_by(pid_t child, const sigset_t& signals, pid_t parent) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (parent != 0 && ::getppid() != parent) ::kill(child, SIGKILL);
    int signal = 0;
    ::sigwait(&signals, &signal);
    if (signal != SIGCHLD) ::kill(child, signal);
  }
  end_all_children();
  if (WIFSIGNALED(status)) {
    const rlimit no_core{};  // The child has written one.
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::signal(WTERMSIG(status), SIG_DFL);
    ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    ::raise(WTERMSIG(status));
  }
  ::_exit(WEXITSTATUS(status));
}

std::size_t take_place() {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    pid_t free = kFree;
    if (groups[i].compare_exchange_strong(free, kTaken)) return i;
  }
  throw runner::TargetBroken("cannot be started: too many processes are attached");
}

}  // namespace

void end_groups_on_signals() {
  struct sigaction ours {};
  ours.sa_handler = end_groups;
  ours.sa_mask = all_signals();
  for (const int signal : kSignals) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(signal, &ours, nullptr);
  }
}

void guard_children() {
  ::signal(SIGCHLD, SIG_DFL);  // Where it is ignored nobody can wait for a child.
  sigset_t signals = all_signals();
  ::sigaddset(&signals, SIGCHLD);
  sigset_t before;
  ::pthread_sigmask(SIG_BLOCK, &signals, &before);
  const pid_t first = ::getpid();
  const pid_t guard = ::fork();
  if (guard > 0) stand_by(guard, signals, 0);
  if (guard == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGCHLD);
    const pid_t worker = ::fork();
    if (worker > 0) {
      ::setpgid(0, 0);  // What kills the group of the other two leaves this one.
      stand_by(worker, signals, first);
    }
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

GroupStart::GroupStart() : place_(take_place()) {
  const sigset_t all = all_signals();
  ::pthread_sigmask(SIG_BLOCK, &all, &before_);
  ++starting;
  if (ending) {  // Another thread's handler may have been first.
    --starting;
    wait_for_end();
  }
}

GroupStart::~GroupStart() {
  if (!started_) groups[place_] = kFree;
  --starting;
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::size_t GroupStart::started(pid_t group) {
  groups[place_] = group;
  started_ = true;
  return place_;
}

void GroupStart::in_child() {
  for (const int signal : kSignals) {
    struct sigaction now {};
    ::sigaction(signal, nullptr, &now);
    if (now.sa_handler != end_groups) continue;
    now.sa_handler = SIG_DFL;
    ::sigaction(signal, &now, nullptr);
  }
  for (std::atomic<pid_t>& group : groups) group = kFree;
  starting = 0;
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

GroupsNow groups_now(pid_t pid) {
  GroupsNow out;
  for (const std::atomic<pid_t>& group : groups) {
    const pid_t id = group;
    out.is_leader = out.is_leader || id == pid;
    out.any = out.any || id != kFree;
    out.starting = out.starting || id == kTaken;
  }
  return out;
}

void forget_group(std::size_t place) {
  groups[place] = kFree;
  if (ending) wait_for_end();  // A handler may have read the number: it must not become another's.
}

}  // namespace rubric::targets
