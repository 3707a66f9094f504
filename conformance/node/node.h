// A mote, sink or base station of the RUBICON Communication Layer, without I/O: its driver passes
// events in and puts its packets on the lines. No heap, no exceptions.
//
// The driver's interface has six functions: Node::start, run, received, sent and set_busy, and
// Driver::transmit. Time comes in by `run` alone: all other functions, calls of the application
// included, happen at the time of the last `run`. So a driver calls `run` before it passes on an
// event, and again after it, since timers may have been set.
#pragma once

#include "codec/generated/rubicon/net_msg.h"
#include "conformance/node/admissions.h"
#include "conformance/node/awaiting.h"
#include "conformance/node/channels.h"
#include "conformance/node/driver.h"
#include "conformance/node/message.h"

namespace rubric {
namespace node {

constexpr uint8_t kLines = 3;

/// The settings of a node when it starts.
struct Setup {
  Role role;
  uint16_t id;            ///< TinyOS id of a mote or sink.
  uint16_t island;        ///< Of a sink or base station.
  uint8_t channels;       ///< Of each direction, if there is room.
  uint16_t last_seq_num;  ///< The number used last, before the node lost its memory.
  Ticks now;
  /// How many ticks longer timers run: 1 with a clock that rounds down, as the tick in which they
  /// begin has partly gone.
  uint8_t slack = 0;
  uint8_t members = 0xFF;  ///< Of a sink's list, if there is room.
};

/// The memory that a node borrows.
struct Buffers {
  Message* messages;  ///< For each line its outgoing buffer, then its incoming one.
  uint8_t out[kLines];
  uint8_t in[kLines];
  Channel* channels;  ///< Outputs, then inputs.
  uint8_t channels_room;
  AwaitedAck* awaited;
  uint8_t awaited_room;
  Admission* admissions;
  uint8_t members_max;
};

/// Its functions are called from one thread or from the main loop, never from an interrupt.
class Node {
 public:
  Node(Driver& driver, Application& application, const Buffers& buffers);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  // The driver's.

  /// Begins anew, with all lines free and on.
  void start(const Setup& setup);
  /// Sets the time and does what is due; to be called at least at the time that it sets `due` to.
  /// Returns false if no timer runs.
  bool run(Ticks now, Ticks& due);
  /// Handles a packet, from its dispatch byte on; ignores those that are for others, or broken.
  void received(Line line, Bytes packet);
  /// Handles the end of a transmission; `acked` if the receiver's radio confirmed it.
  void sent(Line line, bool acked);
  /// Notes that another station takes the line, or leaves it.
  void set_busy(Line line, bool busy);

  // Calls of the application, by the paper's names. What can be refused returns whether it was
  // done.

  /// Joins; ends in Application::joined, perhaps before this returns.
  void join(const Descriptor& descriptor);
  /// Returns the sequence number, or kNoSeq if the message is refused; see refusal.h.
  uint16_t send(Address dest, uint8_t app_id, bool reliable, Bytes data);
  /// Switches the radio or the serial line.
  bool set_interface(Line line, bool on);
  bool interface_is_on(Line line) const { return at(line).on; }
  /// Sets the island of a base station and of its sink.
  bool set_island(uint16_t island);
  /// A base station has no channels: it refuses this and the next calls. (decision 135)
  ChannelResult create_out(Address dest, uint8_t size, Mode mode) {
    if (is_base_station()) return {0, false};
    return channels_.create(true, address(), dest, size, mode);
  }
  ChannelResult create_in(Address src, uint8_t size, Mode mode) {
    if (is_base_station()) return {0, false};
    return channels_.create(false, address(), src, size, mode);
  }
  bool dispose(ChannelId id) { return channels_.dispose(id); }
  bool start_channel(ChannelId id) { return channels_.start(id, now_, phase()); }
  bool stop_channel(ChannelId id) { return channels_.stop(id); }
  bool start_all() {
    channels_.start_all(now_, phase());
    return !is_base_station();
  }
  bool stop_all() {
    channels_.stop_all();
    return !is_base_station();
  }
  bool write_output(ChannelId id, uint8_t pos, float value) {
    return channels_.write(id, pos, value);
  }
  InputValue read_input(ChannelId id, uint8_t pos) { return channels_.read(id, pos); }
  bool set_time_step(uint16_t ticks) {
    return !is_base_station() && channels_.set_period(ticks, now_);
  }
  /// Returns milliseconds; for a member the clock of its island.
  uint32_t clock_ms() const { return time_ms() + clock_offset_ms_; }
  /// Returns whether a sink lists the mote.
  bool lists(uint16_t devid) { return admissions_.lists(devid); }
  /// Return how many motes a sink lists, and whether no other fits.
  uint8_t members() const { return admissions_.members(); }
  bool list_is_full() const { return admissions_.is_full(); }
  /// Returns whether the line's outgoing buffer takes no more, so that what is sent there is lost.
  bool is_full(Line line) const { return at(line).out_ring.count == at(line).out_ring.room; }
  /// Return why `send` would refuse such a message now, and whether `received` would lose the
  /// packet, which is to be passed on and finds no room; for programs that say so: refusal.h.
  Refusal refusal(Address dest, bool reliable, size_t data_bytes) const;
  bool finds_no_room(Line line, Bytes packet) const;
  /// Takes a mote that has left off a sink's list, as no message says goodbye; see silence.h.
  /// Returns false while its report to the base station is owed.
  bool forget(uint16_t devid) { return admissions_.forget(devid); }
  /// While busy, arrivals wait in the incoming buffers.
  void set_application_busy(bool busy);
  Address address() const;
  bool is_member() const { return role_ != Role::kMote || join_.phase == Phase::kMember; }
  uint16_t last_seq_num() const { return awaiting_.last_seq_num(); }

 private:
  struct LineState {
    Queue out() { return Queue(slots, out_ring); }
    Queue in() { return Queue(slots + out_ring.room, in_ring); }

    Message* slots;
    Ring out_ring;
    Ring in_ring;
    bool on : 1;
    bool sending : 1;
    bool busy : 1;      ///< Somebody else has it.
    bool flushing : 1;  ///< The driver may report the end from Driver::transmit.
  };
  enum class Phase : uint8_t { kOutside, kJoining, kMember };
  struct Join {
    Phase phase;
    uint8_t requests;
    uint8_t acks;
    bool acked;
    uint16_t seq_num;
    uint16_t island;
    uint16_t sink;
    Descriptor descriptor;
    Ticks due;
    Ticks accepted;
  };
  struct Route {
    bool deliver;
    bool onward;
    Line line;
    uint16_t am_dest;
  };
  struct OwnMessage {
    Address dest;
    uint8_t trans_id;
    uint8_t app_id;
    bool reliable;
    Bytes data;
  };

  static LineState borrowed(const Buffers& buffers, Line line);
  LineState& at(Line line) { return lines_[static_cast<uint8_t>(line)]; }
  const LineState& at(Line line) const { return lines_[static_cast<uint8_t>(line)]; }
  bool is_sink() const { return role_ == Role::kSink; }
  bool is_base_station() const { return role_ == Role::kBaseStation; }
  Ticks phase() const;
  uint32_t time_ms() const;

  // own.h
  bool next_due(Ticks& due) const;
  bool route_own(Address& dest, Route& route) const;
  uint16_t send_own(const OwnMessage& own);
  void tick();
  void send_values(Channel& channel);

  // lines.h
  Message* take_place(Line line);
  void send_message(Line line, Message& message, uint16_t dest, uint8_t type, size_t bytes);
  void send_net_msg(Line line, Message& message, uint16_t dest, size_t bytes);
  void flush(Line line);
  void leave(Message& message);
  void forget_waiting(uint8_t type);
  bool is_waiting(uint8_t type);

  // joining.h
  void send_join_request();
  void send_ack_join();
  bool ack_join_is_late() const;
  void ack_join_left(bool acked);
  void join_timer_due();
  void hear_join_request(uint16_t src, Bytes payload);
  void hear_join_reply(uint16_t src, Bytes payload);
  void hear_ack_join(uint16_t src, Bytes payload);
  void report_members();
  void hear_config(Bytes payload);

  // receive.h
  bool is_for_me(Line line, uint16_t dest) const;
  bool is_known(Line line, uint8_t type) const;
  void wait(Line line, uint16_t src, uint8_t type, Bytes payload);
  void handle(Line line, uint16_t src, uint8_t type, Bytes payload);
  void handle_waiting();
  void hear_net_msg(Line line, Bytes payload);
  Route route_received(Line line, Address dest, Address src) const;
  Route route_radio(Address dest, Address src) const;
  Route route_serial(Address dest) const;
  Route route_to_pc_lines(Address dest) const;
  void forward(const Route& route, rubicon::NetMsgView message);
  void deliver(rubicon::NetMsgView message);
  void hear_connless(rubicon::NetMsgView message, uint8_t app_id, Bytes data);

  Driver& driver_;
  Application& application_;
  LineState lines_[kLines];
  Channels channels_;
  Awaiting awaiting_;
  Admissions admissions_;
  Join join_{};
  Ticks now_ = 0;
  uint32_t clock_offset_ms_ = 0;
  uint16_t id_ = 0;
  uint16_t island_ = 0;  ///< Of a sink or base station.
  Role role_ = Role::kMote;
  uint8_t arrivals_ = 0;
  uint8_t slack_ = 0;
  bool application_busy_ : 1;
  bool sending_ack_join_ : 1;
};

}  // namespace node
}  // namespace rubric

#include "conformance/node/joining.h"  // The definitions.
#include "conformance/node/lines.h"
#include "conformance/node/memory.h"
#include "conformance/node/own.h"
#include "conformance/node/receive.h"
