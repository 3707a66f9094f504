// Events of a node, and its outputs: the whole interface of the machine.
#pragma once

#include <cstdint>
#include <variant>

#include "codec/runtime/bytes.h"
#include "codec/runtime/rule.h"
#include "conformance/machine/address.h"
#include "conformance/machine/profile.h"

namespace rubric::machine {

constexpr std::uint8_t kAmPayloadMax = 114;
constexpr std::uint8_t kAppDataMax = 100;  ///< After TRANSID and APPID.

/// An active message. Over PEIS dest and src are islands and the payload is a net_msg. Borrows its
/// bytes; a step keeps none of them.
struct Frame {
  Link link = Link::kRadio;
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  std::uint8_t type = 0;
  Bytes payload;
  Bytes packet = {};  ///< A serial packet that is no active message: all its bytes, for the rest.
};

enum class Mode : std::uint8_t { kReliable, kPowerSave };
enum class Direction : std::uint8_t { kOut, kIn };

/// Source devid in the upper, destination devid in the lower 16 bits.
using ChannelId = std::uint32_t;

// Calls of the application, by the names of the paper's interfaces.
struct JoinIsland {
  Descriptor descriptor;
};
struct Send {
  Address dest;
  std::uint8_t app_id = 0;
  bool reliable = false;
  Bytes data;
};
struct SetInterface {
  Link link = Link::kRadio;
  bool on = false;
};
struct GetInterface {
  Link link = Link::kRadio;
};
struct CreateChannel {
  Direction direction = Direction::kOut;
  Address peer;  ///< Destination of an output, source of an input channel.
  std::uint8_t size = 0;
  Mode mode = Mode::kReliable;
};
struct DisposeChannel {
  ChannelId id = 0;
};
struct StartChannel {
  ChannelId id = 0;
};
struct StopChannel {
  ChannelId id = 0;
};
struct StartAllChannels {};
struct StopAllChannels {};
struct WriteOutput {
  ChannelId id = 0;
  std::uint8_t pos = 0;
  float value = 0;
};
struct ReadInput {
  ChannelId id = 0;
  std::uint8_t pos = 0;
};
struct SetTimeStep {
  std::uint16_t ticks = 0;
};
struct SetIslandId {
  std::uint16_t island = 0;
};  ///< From a base station.
struct GetClock {};

using Call =
    std::variant<JoinIsland, Send, SetInterface, GetInterface, CreateChannel, DisposeChannel,
                 StartChannel, StopChannel, StartAllChannels, StopAllChannels, WriteOutput,
                 ReadInput, SetTimeStep, SetIslandId, GetClock>;

enum class TimerKind : std::uint8_t { kJoin, kAck, kSynaptic, kSilence };
/// One of a node's timers: the join timer, the ack timeout of awaited message `index`, the clock,
/// the silence of the mote that was heard longest ago.
struct Timer {
  TimerKind kind = TimerKind::kJoin;
  std::uint8_t index = 0;
  friend bool operator==(const Timer&, const Timer&) = default;
};

// Events.
struct Heard {
  Frame frame;
};  ///< A line brought a frame, whoever it is for.
struct Called {
  Call call;
};  ///< The application calls.
struct TimerDue {
  Timer timer;
};  ///< The driver says when; see timers().
struct SendDone {
  Link link = Link::kRadio;
  bool acked = true;
};  ///< The last transmission ended.
struct LinkBusy {
  Link link = Link::kRadio;
  bool busy = false;
};  ///< Somebody else has the line.
struct AppBusy {
  bool busy = false;
};                   ///< While busy, what arrives is queued.
struct Reboot {};    ///< Memory is lost but for the last sequence number.
struct PowerOff {};  ///< The same, and nothing has an effect until Reboot.

using Event = std::variant<Heard, Called, TimerDue, SendDone, LinkBusy, AppBusy, Reboot, PowerOff>;

// Notices for the application, results of calls among them.
struct Joined {
  Address address;
  bool success = false;
};
struct MoteJoined {
  Address address;
  Descriptor descriptor;
};
/// Nothing came from a mote for as long as the node states. (decision 124)
struct MoteLeft {
  Address address;
};
struct SendResult {
  std::uint16_t seq_num = kNoSeq;
};
struct Received {
  Address src;
  std::uint8_t app_id = 0;
  Bytes data;
};  ///< Until the next step.
struct AckReceived {
  std::uint8_t app_id = 0;
  std::uint16_t seq_num = 0;
  bool success = false;
};
enum class DataStatus : std::uint8_t { kNew, kOld, kUnknownChannel };
struct SynDataReceived {
  ChannelId id = 0;
  DataStatus status = DataStatus::kNew;
};
struct ChannelResult {
  ChannelId id = 0;
  bool success = false;
};
struct OperationResult {
  bool success = false;
};  ///< For calls without other results.
struct InputValue {
  float value = 0;
  bool success = false;
};
struct InterfaceState {
  Link link = Link::kRadio;
  bool on = false;
};
struct Clock {
  std::uint32_t ms = 0;
};

using Notice =
    std::variant<Joined, MoteJoined, MoteLeft, SendResult, Received, AckReceived, SynDataReceived,
                 ChannelResult, OperationResult, InputValue, InterfaceState, Clock>;

/// Returns whether it is the result of a call that has one, whatever else happens.
inline bool is_result(const Notice& notice) {
  return std::holds_alternative<SendResult>(notice) ||
         std::holds_alternative<ChannelResult>(notice) ||
         std::holds_alternative<OperationResult>(notice) ||
         std::holds_alternative<InputValue>(notice) ||
         std::holds_alternative<InterfaceState>(notice) || std::holds_alternative<Clock>(notice);
}

}  // namespace rubric::machine
