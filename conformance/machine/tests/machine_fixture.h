// Helpers of the machine's tests: nodes with a clock, frames made by the codec, and checks of a
// step's results. What a node must do is in the golden traces, as source_mutants shows; the tests
// here are for what no trace sees: labels, other profiles, and choices that the rules leave free.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/join.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/step.h"

namespace rubric::machine {

/// A frame with its own bytes.
struct OwnFrame {
  Link link = Link::kRadio;
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  std::uint8_t type = 0;
  std::vector<std::uint8_t> payload;
  Frame frame() const { return {link, dest, src, type, {payload.data(), payload.size()}}; }
};

template <class Message>
std::vector<std::uint8_t> written(const Message& message) {
  std::uint8_t room[kAmPayloadMax];
  const auto bytes = write(message, MutableBytes(room));
  EXPECT_TRUE(bytes);
  return {bytes->data(), bytes->data() + bytes->size()};
}

struct NetFields {
  Address dest;
  Address src;
  bool reliable = false;
  std::uint16_t seq_num = 7;
  std::vector<std::uint8_t> payload = {3, 10, 0xAB};  ///< CONNLESS, CONTROL_LAYER, a body.
};
inline std::vector<std::uint8_t> net_msg(const NetFields& fields) {
  rubicon::NetMsg message;
  message.dest = wire_of(fields.dest);
  message.src = wire_of(fields.src);
  message.reliable = fields.reliable ? 1 : 0;
  message.seq_num = fields.seq_num;
  message.payload = {fields.payload.data(), fields.payload.size()};
  return written(message);
}
inline std::vector<std::uint8_t> padded(std::vector<std::uint8_t> bytes) {
  bytes.resize(kAmPayloadMax);
  return bytes;
}

inline OwnFrame join_request(std::uint16_t mote, std::uint16_t seq_num, const Descriptor& what) {
  rubicon::JoinRequest request;
  request.seq_num = seq_num;
  request.mote_desc = wire_of(what);
  return {Link::kRadio, 1, mote, am::kJoin, written(request)};
}
inline OwnFrame join_reply(std::uint16_t am_dest, Address offered, std::uint32_t time_ms,
                           std::uint16_t seq_num, std::uint16_t am_src = 1) {
  rubicon::JoinReply reply;
  reply.island_addr = offered.pid;
  reply.mote_addr = offered.devid;
  reply.cur_time = time_ms;
  reply.seq_num = seq_num;
  return {Link::kRadio, am_dest, am_src, am::kJoinReply, written(reply)};
}
inline OwnFrame ack_join(Address dest, Address src, std::uint16_t seq_num, const Descriptor& what) {
  rubicon::AckJoin ack;
  ack.dest = wire_of(dest);
  ack.src = wire_of(src);
  ack.seq_num = seq_num;
  ack.mote_desc = wire_of(what);
  return {Link::kRadio, dest.devid, src.devid, am::kAckJoin, written(ack)};
}
inline OwnFrame config(std::uint8_t code, std::uint16_t value) {
  rubicon::Config wire;
  wire.type = static_cast<rubicon::CommandCode>(code);
  wire.value = value;
  return {Link::kSerial, 1, 0, am::kConfig, written(wire)};
}
inline OwnFrame set_island_id(std::uint16_t island) { return config(10, island); }

/// A label of an action, for comparing whole steps.
struct Label {
  Action::What what;
  ReqId requirement;
  friend bool operator==(const Label&, const Label&) = default;
};
inline void PrintTo(const Label& label, std::ostream* out) {
  constexpr const char* kNames[] = {"transmit", "notify", "followed", "ignored"};
  *out << kNames[static_cast<int>(label.what)] << ' ' << static_cast<int>(label.requirement);
}
inline Label sent(ReqId requirement) { return {Action::What::kTransmit, requirement}; }
inline Label notified(ReqId requirement) { return {Action::What::kNotify, requirement}; }
inline Label followed(ReqId requirement) { return {Action::What::kFollowed, requirement}; }
inline Label ignored(ReqId requirement) { return {Action::What::kIgnored, requirement}; }

/// One node at its present time.
struct Device {
  explicit Device(const Config& config) : state(start(config)) {}

  Device& step(const Event& event) {
    machine::step(state, now, event, actions);
    return *this;
  }
  Device& hear(const OwnFrame& frame) {
    heard = frame;  // The frame stays readable until the next step.
    return step(Heard{heard.frame()});
  }
  Device& hear(const Transmit& transmit) { return step(Heard{transmit.frame()}); }
  Device& call(const Call& what) { return step(Called{what}); }
  Device& done(Link link = Link::kRadio, bool acked = true) { return step(SendDone{link, acked}); }
  /// Lets the join timer fire when it is due.
  Device& join_timer() {
    now = state.join.due;
    return step(TimerDue{{TimerKind::kJoin, 0}});
  }

  std::vector<Label> labels() const {
    std::vector<Label> all;
    for (const Action& action : actions.all()) all.push_back({action.what, action.requirement});
    return all;
  }
  /// Returns the one notice of this kind in the last step; fails the test if there is another
  /// number.
  template <class Kind>
  Kind notice() const {
    Kind found{};
    int count = 0;
    for (const Notice& each : actions.notices()) {
      if (const auto* kind = std::get_if<Kind>(&each)) found = *kind, ++count;
    }
    EXPECT_EQ(count, 1);
    return found;
  }
  /// Returns the one frame of the last step.
  const Transmit& only_frame() const {
    EXPECT_EQ(actions.transmits().size(), 1U);
    static const Transmit kNothing{};
    return actions.transmits().empty() ? kNothing : actions.transmits()[0];
  }
  std::vector<std::uint8_t> only_payload() const {
    const Bytes bytes = only_frame().bytes();
    return {bytes.begin(), bytes.end()};
  }
  bool silent() const { return actions.transmits().empty() && actions.notices().empty(); }

  State state;
  Ticks now = 0;
  Actions actions;
  OwnFrame heard;
};

inline constexpr Descriptor kDescriptor{1, 1, 0x43};
inline constexpr std::uint16_t kIsland = 11;
inline constexpr std::uint16_t kOther = 12;  ///< Another island.

inline Config mote_config(std::uint16_t id) { return {.id = id}; }
inline Config sink_config(std::uint16_t island = kIsland) {
  return {.role = Role::kSink, .id = 1, .island = island};
}
inline Config base_config(std::uint16_t island = kIsland) {
  return {.role = Role::kBaseStation, .island = island};
}

/// Returns a mote that is a member of kIsland and has nothing to send.
inline Device member(std::uint16_t id, const Config* config = nullptr) {
  Device mote(config == nullptr ? mote_config(id) : *config);
  mote.call(JoinIsland{kDescriptor}).done();
  mote.hear(join_reply(id, {kIsland, id}, 0, mote.state.join.seq_num)).done();
  EXPECT_EQ(mote.state.join.phase, JoinMote::Phase::kMember);
  return mote;
}
/// Makes a sink of kIsland list `id`.
inline void list_member(Device& sink, std::uint16_t id, std::uint16_t seq_num = 100) {
  sink.hear(join_request(id, seq_num, kDescriptor)).done();
  sink.hear(ack_join({kIsland, 1}, {kIsland, id}, seq_num, kDescriptor)).done(Link::kSerial);
  EXPECT_NE(find_member(sink.state.sink, id), nullptr);
}

}  // namespace rubric::machine
