// The outgoing buffer of one line: frames that find the line busy wait, in order (N2).
#pragma once

#include <cstddef>
#include <deque>
#include <functional>

#include "conformance/adapters/cpp/world.h"

namespace rubric::cpp_node {

class OutLine {
 public:
  /// Puts a frame on the line, which is free.
  using Transmit = std::function<void(Line line, const Frame& frame)>;

  OutLine(Line line, std::size_t room, Transmit transmit)
      : line_(line), room_(room), transmit_(std::move(transmit)) {}

  /// Returns false, and does nothing, if the buffer is full or the interface off.
  bool push(Frame frame);
  bool has_room() const { return on_ && waiting_.size() < room_; }
  /// Returns whether a frame pushed now leaves at once.
  bool is_free() const { return on_ && !busy_ && !unconfirmed_ && waiting_.empty(); }
  /// Returns whether a frame of this type waits.
  bool holds(AmType type) const;
  /// Drops waiting frames of this type.
  void drop(AmType type);

  /// Notes that another station has the line, or leaves it.
  void set_busy(bool busy);
  void set_on(bool on);
  bool is_on() const { return on_; }
  /// Ends the transmission that asked for a link ack; returns false if there is none.
  bool confirmed();

 private:
  void send_waiting();

  Line line_;
  std::size_t room_;
  Transmit transmit_;
  std::deque<Frame> waiting_;
  bool on_ = true;
  bool busy_ = false;
  bool unconfirmed_ = false;
};

}  // namespace rubric::cpp_node
