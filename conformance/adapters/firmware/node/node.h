// A mote or a sink of the RUBICON Communication Layer, without hardware: a board passes events in,
// and the node uses the board through the interfaces of ports.h. No heap, no exceptions.
#pragma once

#include "codec/generated/rubicon/net_msg.h"
#include "conformance/adapters/firmware/node/admissions.h"
#include "conformance/adapters/firmware/node/awaiting.h"
#include "conformance/adapters/firmware/node/channels.h"
#include "conformance/adapters/firmware/node/message.h"
#include "conformance/adapters/firmware/node/ports.h"

namespace rubric {
namespace firmware {

/// A board's settings for its node when it starts.
struct Setup {
  uint16_t id;            ///< TinyOS id.
  uint16_t island;        ///< For a sink.
  uint8_t channels;       ///< For each direction, at most kChannelsRoom.
  uint16_t last_seq_num;  ///< The number used last, before the node lost its memory.
};

/// Its functions are called from one thread or from the main loop, never from an interrupt.
class Node {
 public:
  Node(Radio& radio, SerialLine& serial, const Clock& clock, Application& application)
      : radio_port_(radio), serial_port_(serial), clock_(clock), application_(application) {}
  void start(const Setup& setup);

  // Calls of the application, by the paper's names.

  /// Joins; ends in Application::joined, perhaps before this returns.
  void join(const Descriptor& descriptor);
  /// Returns the sequence number, or kNoSeq if the message is refused.
  uint16_t send(Address dest, uint8_t app_id, bool reliable, Bytes data);
  void set_interface(Line line, bool on);
  bool interface_is_on(Line line) const { return line_of(line).on; }
  ChannelResult create_out(Address dest, uint8_t size, Mode mode) {
    return channels_.create(true, address(), dest, size, mode);
  }
  ChannelResult create_in(Address src, uint8_t size, Mode mode) {
    return channels_.create(false, address(), src, size, mode);
  }
  bool start_channel(ChannelId id) { return channels_.start(id, clock_.now(), phase()); }
  void start_all() { channels_.start_all(clock_.now(), phase()); }
  bool set_time_step(uint16_t ticks) { return channels_.set_period(ticks, clock_.now()); }
  /// Dispose, stop, stop_all, write and read are those of the channels.
  Channels& channels() { return channels_; }
  /// Returns milliseconds; for a member the clock of its island.
  uint32_t clock_ms() const;
  /// While busy, arrivals wait in the incoming buffers.
  void set_application_busy(bool busy);
  Address address() const;
  uint16_t last_seq_num() const { return awaiting_.last_seq_num(); }

  // Events from the board.

  /// Handles a frame that is addressed to this node or to all; ignores longer ones than
  /// kAmPayloadMax.
  void radio_received(uint16_t dest, uint16_t src, uint8_t am_type, Bytes payload);
  /// Handles the end of the frame given to Radio::send; `acked` if the receiver's radio confirmed
  /// it.
  void radio_sent(bool acked);
  /// Handles a packet, from its dispatch byte on.
  void serial_received(Bytes packet);
  void serial_sent();
  /// Notes that another station takes the line, or leaves it.
  void set_line_busy(Line line, bool busy);
  /// Does what is due; to be called at least at the time of next_due.
  void run_timers();
  /// Returns false if no timer runs.
  bool next_due(Ticks& due) const;

 private:
  struct LineState {
    LineState(Queue outgoing, Queue incoming) : out(outgoing), in(incoming) {}
    Queue out;
    Queue in;
    bool on = true;
    bool sending = false;
    bool busy = false;  ///< Somebody else has it.
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

  LineState& line_of(Line line) { return line == Line::kRadio ? radio_ : serial_; }
  const LineState& line_of(Line line) const { return line == Line::kRadio ? radio_ : serial_; }
  bool is_member() const { return kIsSink || join_.phase == Phase::kMember; }
  Ticks phase() const;
  uint32_t uptime_ms() const;

  // node.cc
  bool route_own(Address& dest, Route& route) const;
  uint16_t send_own(const OwnMessage& own);
  void tick();
  void send_values(Channel& channel);

  // lines.cc
  Message* take_place(Line line);
  void send_message(Line line, Message& message, uint16_t dest, uint8_t type, size_t bytes);
  void send_net_msg(Line line, Message& message, uint16_t dest, size_t bytes);
  void flush(Line line);
  void flush_radio();
  void flush_serial();
  void leave(Message& message);
  void forget_waiting(uint8_t type);
  bool is_waiting(uint8_t type);

  // joining.cc
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

  // receive.cc
  void receive(Line line, uint16_t src, uint8_t type, Bytes payload);
  void wait(Line line, uint16_t src, uint8_t type, Bytes payload);
  void handle(Line line, uint16_t src, uint8_t type, Bytes payload);
  void handle_waiting();
  void hear_net_msg(Line line, Bytes payload);
  Route route_radio(Address dest, Address src) const;
  Route route_serial(Address dest) const;
  void forward(const Route& route, rubicon::NetMsgView message);
  void deliver(rubicon::NetMsgView message);
  void hear_connless(rubicon::NetMsgView message, uint8_t app_id, Bytes data);

  Radio& radio_port_;
  SerialLine& serial_port_;
  const Clock& clock_;
  Application& application_;

  Message radio_out_[kRadioOutRoom];
  Message radio_in_[kRadioInRoom];
  Message serial_out_[kSerialOutRoom];
  Message serial_in_[kSerialInRoom];
  LineState radio_{Queue(radio_out_), Queue(radio_in_)};
  LineState serial_{Queue(serial_out_), Queue(serial_in_)};
  Channels channels_;
  Awaiting awaiting_;
  Admissions admissions_;
  Join join_{};
  uint32_t clock_offset_ms_ = 0;
  uint16_t id_ = 0;
  uint16_t island_ = 0;  ///< For a sink.
  uint8_t arrivals_ = 0;
  bool application_busy_ = false;
  bool sending_ack_join_ = false;
};
// A host has longer pointers than a mote.
static_assert(sizeof(void*) > 4 || kChannelsRoom > 4 || sizeof(Node) <= kPaperTotalBytes,
              "a node takes more memory than the paper's");

}  // namespace firmware
}  // namespace rubric
