// Runs the network after faults have stopped: frames arrive in the order in which they were sent,
// link acks come, timers fire only when nothing else happens.
#pragma once

#include <deque>

#include "conformance/explore/network.h"

namespace rubric::explore {

class Healing {
 public:
  explicit Healing(Network& network) : network_(network) {}

  /// Returns, for a state in which no node has anything to do, whether a call of each mote that is
  /// no member, alone and after the others', makes it one that its sink lists. Sets `weak` if one
  /// could not because it has rebooted and a sink still lists it (spec/membership.md), which is
  /// known.
  bool succeeds(const World& world, bool& weak);

 private:
  bool joins(World& world, std::size_t mote);
  void happen(World& world, std::size_t node, std::uint32_t what);
  bool advance(World& world);

  Network& network_;
  std::deque<Copy> air_;
};

}  // namespace rubric::explore
