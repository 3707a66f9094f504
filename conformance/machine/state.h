// The state of a node: a plain value made of small parts, each with the functions that change it.
// The parts are independent, so that the checker can follow one mote's join, or one sink's
// view of one mote, without a whole node.
#pragma once

#include <array>
#include <cstdint>

#include "conformance/machine/address.h"
#include "conformance/machine/bounded.h"
#include "conformance/machine/event.h"
#include "conformance/machine/profile.h"

namespace rubric::machine {

constexpr std::size_t kMembersMax = 20;  ///< In a sink's list (release 1.0).
constexpr std::size_t kPendingMax = 20;  ///< Joins that a sink has answered and not seen acked.
constexpr std::size_t kAwaitedMax = 8;   ///< Reliable messages whose ack is awaited at once.
constexpr std::size_t kRadioRoom = 4;    ///< Messages in each direction of the radio (the paper).
constexpr std::size_t kSerialRoom = 2;   ///< The same of the serial line.
/// In each direction, at most; Profile::channels_max is the number of a node (decision 129).
constexpr std::size_t kChannelsRoom = 8;
constexpr std::size_t kConnectionsMax = 10;

/// Properties that do not change while a node runs.
struct Config {
  Role role = Role::kMote;
  std::uint16_t id = 0;      ///< TinyOS id: the AM address and the devid. A base station has none.
  std::uint16_t island = 0;  ///< Start value of a sink or base station.
  Profile profile;
  std::uint16_t first_seq = 1;  ///< Sequence numbers start here.
  bool random_seq = false;      ///< Else they count.
  friend bool operator==(const Config&, const Config&) = default;
};

/// A mote's part in joining. A member whose ack_join the link layer has not confirmed is !acked.
struct JoinMote {
  enum class Phase : std::uint8_t { kOutside, kJoining, kMember };
  Phase phase = Phase::kOutside;
  std::uint8_t requests = 0;  ///< In the present or last call; the first and one an expiry.
  std::uint8_t acks = 0;      ///< ack_join sent for the accepted reply.
  bool acked = false;         ///< The link layer confirmed ack_join.
  std::uint16_t seq_num = 0;  ///< In the present or last call's requests.
  std::uint16_t sink_devid = 0;
  Address address;  ///< While a member.
  Descriptor descriptor;
  Ticks due = 0;       ///< The timer's expiry, while joining; else 0.
  Ticks accepted = 0;  ///< Time of the accepted reply.
  bool asked = false;  ///< A request of the present or last call has left.
  friend bool operator==(const JoinMote&, const JoinMote&) = default;
};

/// A sink's view of one mote: a request answered, or a member.
struct Admission {
  std::uint16_t devid = 0;
  std::uint16_t seq_num = 0;  ///< In the request answered last.
  Descriptor descriptor;      ///< In the same request.
  friend bool operator==(const Admission&, const Admission&) = default;
};

/// When something came last from a mote of the island; kept by nodes that call silent ones gone.
struct Presence {
  std::uint16_t devid = 0;
  Ticks heard = 0;
  friend bool operator==(const Presence&, const Presence&) = default;
};

/// A sink's part in joining.
struct JoinSink {
  BoundedList<Admission, kMembersMax> members;
  BoundedList<Admission, kPendingMax> pending;     ///< Oldest first.
  BoundedList<Admission, kMembersMax> unreported;  ///< Members whose report waits for the line.
  friend bool operator==(const JoinSink&, const JoinSink&) = default;
};

/// A reliable message whose ack is awaited.
struct Awaited {
  std::uint16_t seq_num = 0;
  std::uint8_t app_id = 0;
  Address dest;
  Ticks due = 0;  ///< End of its time; 0: it waits for the line, or there is no timeout.
  friend bool operator==(const Awaited&, const Awaited&) = default;
};

/// Sequence numbers: counting, or pseudo-random; never kNoSeq.
struct Sequence {
  std::uint16_t last = 0;
  bool random = false;
  friend bool operator==(const Sequence&, const Sequence&) = default;
};

/// A message in a buffer. (paper: 122 bytes a message)
struct Buffered {
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  std::uint8_t type = 0;
  std::uint8_t size_bytes = 0;
  bool link_ack = false;
  std::uint16_t awaited = kNoSeq;    ///< Its number, if it is the node's own and awaits its ack.
  ReqId requirement = ReqId::kNone;  ///< Why it was sent.
  std::array<std::uint8_t, kAmPayloadMax> payload;
  Bytes bytes() const { return {payload.data(), size_bytes}; }
  friend bool operator==(const Buffered& a, const Buffered& b) {
    return a.dest == b.dest && a.src == b.src && a.type == b.type && a.link_ack == b.link_ack &&
           a.awaited == b.awaited && equal(a.bytes(), b.bytes());
  }
};

/// A line: on or off, free or not, with its waiting frames.
template <std::size_t kRoom>
struct Interface {
  bool on = true;
  bool sending = false;           ///< Until SendDone.
  bool sending_ack_join = false;  ///< The frame being sent is an ack_join.
  bool taken = false;             ///< Somebody else has the line.
  BoundedQueue<Buffered, kRoom> out;
  BoundedQueue<Buffered, kRoom> in;
  friend bool operator==(const Interface&, const Interface&) = default;
};

/// One end of a synaptic channel. Values are kept as their bits so that states compare exactly.
struct Channel {
  ChannelId id = 0;
  Address peer;
  Mode mode = Mode::kReliable;
  std::uint8_t size = 0;
  bool started = false;
  bool fresh = false;  ///< Out: changed, or first tick after start. In: came since the last tick.
  std::array<std::uint32_t, kConnectionsMax> value_bits{};
  friend bool operator==(const Channel&, const Channel&) = default;
};

/// Synaptic channels of a node and their one clock.
struct Synaptic {
  BoundedList<Channel, kChannelsRoom> out;
  BoundedList<Channel, kChannelsRoom> in;
  std::uint16_t period_ticks = 0;
  Ticks due = 0;          ///< Next tick; 0 while no channel is started.
  Ticks phase_ticks = 0;  ///< Delay of the clock's first tick; 0 from that tick on.
  friend bool operator==(const Synaptic&, const Synaptic&) = default;
};

/// A node. Plain, comparable, hashable (hash_value), no heap.
struct State {
  Config config;
  std::uint16_t island = 0;           ///< A sink's or base station's, now.
  std::uint32_t clock_offset_ms = 0;  ///< Own clock = time since start + this.
  bool off = false;                   ///< Without power, until Reboot; all else is as at start.
  bool app_busy = false;
  Sequence sequence;
  JoinMote join;
  JoinSink sink;
  BoundedList<Presence, kMembersMax> present;
  BoundedList<Awaited, kAwaitedMax> awaited;
  Synaptic synaptic;
  Interface<kRadioRoom> radio;
  Interface<kSerialRoom> serial;
  /// The lines of what is in radio.in and serial.in, by arrival.
  BoundedQueue<Link, kRadioRoom + kSerialRoom> waiting;
  friend bool operator==(const State&, const State&) = default;
};

}  // namespace rubric::machine
