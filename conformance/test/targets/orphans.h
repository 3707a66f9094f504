// Processes that an adapter left behind: in a session of its own a process does not belong to the
// adapter's group any more. Where its parent ends, this process becomes its parent, as it is their
// subreaper (prctl(2)), and so can find and end it.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace rubric::targets {

/// The environment of a child, with a mark by which its descendants are known.
class MarkedEnvironment {
 public:
  /// Makes this process a subreaper, too.
  MarkedEnvironment();
  char* const* get() { return words_.data(); }
  const std::string& mark() const { return texts_.front(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> words_;
};

/// Ends all that became children of this process and carry the mark, and what these leave behind.
/// Processes without a readable environment are ended once no group is left. Returns within
/// seconds, whatever they do. Without /proc it does nothing.
void end_orphans(const std::string& mark);

/// Ends all children of this process, for a handler of signals after which it ends itself.
void end_all_children();

}  // namespace rubric::targets
