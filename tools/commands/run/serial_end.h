// One end of the serial line between a sink and its base station.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "codec/lines/line.h"
#include "codec/lines/packet_line.h"

namespace rubric::run {

/// Opens its line again when it is gone, after pauses that double from a quarter of a second to
/// four.
class SerialEnd {
 public:
  /// A base station's: connects to a sink. Says on stderr when the line comes and goes.
  explicit SerialEnd(const lines::Address& to);
  /// A sink's: "sf-server:PORT", a serial forwarder for one program at a time, or "pty", a serial
  /// device. Throws Broken if that cannot be had.
  explicit SerialEnd(const std::string& offered);

  /// Returns the line's name for the other end, such as sf@localhost:9002.
  const std::string& other_end() const { return other_end_; }
  /// Opens the line if it is time to. Returns whether it has just been opened.
  bool open();
  /// From any thread.
  bool is_open() const { return open_; }
  /// Returns whether the line took the packet.
  bool send(const std::vector<std::uint8_t>& packet);
  /// Returns the next packet; empty if none comes before the deadline.
  std::vector<std::uint8_t> receive(lines::SteadyTime deadline);
  /// Returns the descriptor on which packets come, for poll(); -1 while there is none.
  int fd() const { return open_ ? line_->fd() : -1; }
  /// Returns when open() is to be called again; the end of time while nobody can be waiting.
  lines::SteadyTime next_try() const {
    return open_ && !listener_ ? lines::SteadyTime::max() : next_try_;
  }

 private:
  void turn_another_away();
  void lost(const std::string& why);

  std::string name_;
  std::string other_end_;
  bool waits_for_others_ = false;
  std::shared_ptr<lines::Descriptor> listener_;  // Of a sink that is a serial forwarder.
  std::unique_ptr<lines::PacketLine> line_;
  std::atomic<bool> open_ = false;
  bool said_ = false;
  bool turned_away_ = false;  // And that was said.
  lines::SteadyTime next_try_{};
  lines::Milliseconds pause_;
};

}  // namespace rubric::run
