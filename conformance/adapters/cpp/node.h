// The common part of all nodes: lines, numbers, the transport level, synaptic channels.
//
// A node has no clock and no thread: its driver sets the time (set_time), passes events in, and
// calls back when something is due.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

#include "conformance/adapters/cpp/out_line.h"
#include "conformance/adapters/cpp/synaptic.h"

namespace rubric::cpp_node {

struct Settings {
  std::uint16_t device = 0;       ///< Its TinyOS id; of a base station nothing.
  std::uint16_t island = 0;       ///< Start value of a sink or base station.
  std::size_t channels = 4;       ///< Synaptic ones, of each direction.
  std::uint16_t next_number = 1;  ///< The first sequence number.
  Ticks now = 0;
};

class Node {
 public:
  virtual ~Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  // Time.
  void set_time(Ticks now) { now_ = now; }
  /// Returns when something is due next, if nothing happens before; nothing: never.
  virtual std::optional<Ticks> due() const;
  /// Does what is due now.
  virtual void run_due();

  // From outside.
  void heard(Line line, const Frame& frame);
  void set_busy(Line line, bool busy);
  /// While the application is busy, messages that arrive wait for it.
  void set_application_busy(bool busy);
  /// Handles the end of the transmission that asked for a link ack.
  virtual void confirmed(bool acked);

  // Calls of the application.
  virtual void join(const MoteDesc& description);
  /// Returns the message's sequence number, or kNoNumber if it is refused.
  std::uint16_t send(Address dest, Component application, bool reliable, Bytes data);
  bool set_interface(Line line, bool on);
  std::optional<bool> interface(Line line) const;
  virtual bool set_island(std::uint16_t) { return false; }
  virtual std::uint32_t clock_ms() const;
  std::optional<ChannelId> create(Direction direction, Address peer, std::size_t size, Mode mode);
  bool start_channel(ChannelId id) { return synaptic_.start(id, now_); }
  void start_all_channels() { synaptic_.start_all(now_); }
  Synaptic& synaptic() { return synaptic_; }

  /// Returns the one number that outlives a loss of power.
  std::uint16_t next_number() const { return next_number_; }

 protected:
  Node(const Settings& settings, Ticks phase, World& world);

  /// Returns its address; nothing while it has none.
  virtual std::optional<Address> address() const = 0;
  /// Puts a message that the node sends on the right line; returns false if there is no room or no
  /// route.
  virtual bool route(const Message& message) = 0;
  /// Handles a frame for this node without a net_msg.
  virtual void control(Line line, const Frame& frame) = 0;
  /// Handles a net_msg in a frame for this node.
  virtual void message(Line line, const Message& message) = 0;
  /// Returns whether the frame's AM address means this node.
  virtual bool is_for_me(Line line, const Frame& frame) const = 0;
  /// Called when a frame leaves, maybe long after it was accepted.
  virtual void left(Line, const Frame&) {}
  /// Called when there may be room on a line.
  virtual void may_have_room() {}

  /// Passes a message for this node up to the component of its TRANSID and APPID.
  void deliver(const Message& message);
  std::uint16_t take_number();
  OutLine& line(Line which) { return lines_[static_cast<std::size_t>(which)]; }
  Ticks now() const { return now_; }
  World& world() { return world_; }

 private:
  struct Awaited {
    std::uint16_t number;
    Address dest;
    Component application;
    Ticks deadline;
  };
  struct Waiting {
    Line line;
    Message message;
  };
  OutLine out_line(Line which);
  void acknowledge(const Message& message);
  void settle(const Message& ack);
  bool send_values(Address dest, const Values& values);
  bool is_awaited(std::uint16_t number) const;

  World& world_;
  Ticks now_;
  Ticks started_;
  std::uint16_t next_number_;
  OutLine lines_[3];
  Synaptic synaptic_;
  std::vector<Awaited> awaited_;
  std::deque<Waiting> waiting_;  ///< Messages for a busy application.
  bool application_busy_ = false;
};

}  // namespace rubric::cpp_node
