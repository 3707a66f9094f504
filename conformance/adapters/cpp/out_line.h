// The outgoing buffer of one line: what finds the line busy waits, in order (N2).
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

  /// False, and nothing happens, when the buffer is full or the interface off.
  bool push(Frame frame);
  bool has_room() const { return on_ && waiting_.size() < room_; }
  /// What is pushed now leaves at once.
  bool is_free() const { return on_ && !busy_ && !unconfirmed_ && waiting_.empty(); }
  /// Whether a frame of this type waits.
  bool holds(AmType type) const;
  /// Frames of this type that wait are never sent.
  void drop(AmType type);

  /// Somebody else has the line, or leaves it.
  void set_busy(bool busy);
  void set_on(bool on);
  bool is_on() const { return on_; }
  /// The transmission that asked for a link ack is over; false if there is none.
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
