// Process groups of children that have to end with this process, even if a signal ends it. They do
// not belong to the terminal, so Ctrl-C does not reach them.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <cstddef>

namespace rubric::targets {

/// Lets SIGINT, SIGTERM, SIGHUP and SIGQUIT kill all groups from now on, whatever these do against
/// it, and then this process as they would have without. A signal that is ignored stays ignored.
/// For programs that attach processes; called once, while there is one thread.
void end_groups_on_signals();

/// Goes on in a child of a child of this process, and lets these two wait for it: they pass signals
/// on and end as it does. Even where SIGKILL ends this process, or the one that goes on, or its
/// whole group, the others still end all that was started, also what left its session. For programs
/// that attach processes; called first of all, while there is one thread and little memory. Where
/// no process can be had it does nothing.
void guard_children();

/// Guards the start of a child: signals that would end this process wait until the child's group is
/// known. Several threads may start children at once.
class GroupStart {
 public:
  /// Throws runner::TargetBroken if there are too many groups.
  GroupStart();
  ~GroupStart();
  GroupStart(const GroupStart&) = delete;
  GroupStart& operator=(const GroupStart&) = delete;

  /// Notes that the group exists. Returns its place, for forget_group.
  std::size_t started(pid_t group);
  /// Resets, in the forked child, what belongs to the parent.
  void in_child();

 private:
  sigset_t before_;
  std::size_t place_;
  bool started_ = false;
};

/// The known groups at one moment, and whether a process leads one.
struct GroupsNow {
  bool is_leader = false;  ///< The process leads one.
  bool any = false;        ///< There is at least one.
  bool starting = false;   ///< A child is about to start: it may be any process.
};
GroupsNow groups_now(pid_t pid);

/// Notes that the group was killed; its number may belong to another one after this returns.
void forget_group(std::size_t place);

}  // namespace rubric::targets
