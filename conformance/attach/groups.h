// Process groups of children that have to end with this process, even when a signal ends it: they
// are none of the terminal's, so Ctrl-C does not reach them.
#pragma once

#include <csignal>
#include <cstddef>

#include <sys/types.h>

namespace rubric::attach {

/// SIGINT, SIGTERM, SIGHUP and SIGQUIT kill all groups from now on, whatever these do against it,
/// and then this process as they would have without. A signal that is ignored stays ignored. For
/// programs that attach processes, once, while there is one thread.
void end_groups_on_signals();

/// Stands around the start of a child: signals that would end this process wait until it is known
/// which group it has. Several threads may start children at once.
class GroupStart {
 public:
  /// Throws runner::TargetBroken when there are too many groups.
  GroupStart();
  ~GroupStart();
  GroupStart(const GroupStart&) = delete;
  GroupStart& operator=(const GroupStart&) = delete;

  /// The group is there. Returns its place, for forget_group.
  std::size_t started(pid_t group);
  /// In the forked child: nothing of this is its own.
  void in_child();

 private:
  sigset_t before_;
  std::size_t place_;
  bool started_ = false;
};

/// The group was killed, and its number may be another's from the return on.
void forget_group(std::size_t place);

}  // namespace rubric::attach
