// The serial line of a real node over any carrier.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "codec/lines/time.h"

namespace rubric::lines {

/// A serial forwarder packet and the time of its last byte.
struct TimedPacket {
  SteadyTime time;
  std::vector<std::uint8_t> bytes;
};

/// All functions throw Broken if the line breaks or a forwarder carries nonsense; it is closed
/// then, and open() opens it anew.
class PacketLine {
 public:
  virtual ~PacketLine() = default;
  /// Opens it before `deadline`, unless it is open and the other end is there. Returns whether it
  /// opened it.
  virtual bool open(SteadyTime deadline) = 0;
  virtual void close() = 0;
  virtual void send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) = 0;
  /// Returns the next packet; nothing if the time is over first.
  virtual std::optional<TimedPacket> receive(SteadyTime deadline) = 0;
  /// Returns what the line may have lost or doubled since the last call; empty: nothing.
  virtual std::string take_damage() { return {}; }
  /// Returns the descriptor on which more comes while it is open, for poll(); -1 if there is none.
  virtual int fd() const { return -1; }
};

}  // namespace rubric::lines
