// The serial line of a real node, whatever carries it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/attach/process.h"

namespace rubric::attach {

/// A serial forwarder packet and when its last byte came.
struct TimedPacket {
  SteadyTime time;
  std::vector<std::uint8_t> bytes;
};

/// All throw runner::TargetBroken when the line breaks or carries what makes no sense; it is closed
/// then, and open() opens it anew.
class PacketLine {
 public:
  virtual ~PacketLine() = default;
  /// Opens it before `deadline`, unless it is open and the other end is there.
  virtual void open(SteadyTime deadline) = 0;
  virtual void close() = 0;
  virtual void send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) = 0;
  /// The next packet; nothing when the time is over first.
  virtual std::optional<TimedPacket> receive(SteadyTime deadline) = 0;
};

}  // namespace rubric::attach
