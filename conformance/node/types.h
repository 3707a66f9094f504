// Addresses and other types shared by the parts of a node.
#pragma once

#include <stdint.h>

#include "codec/generated/rubicon/enums.h"
#include "codec/generated/rubicon/mote_desc.h"
#include "codec/generated/rubicon/r_addr.h"

namespace rubric {
namespace node {

constexpr uint16_t kBroadcast = 0xFFFF;    ///< As pid, devid and AM address.
constexpr uint16_t kLocalIsland = 0xFFFE;  ///< Replaced by the own island before sending.
constexpr uint16_t kLocalMote = 0xFFFE;    ///< The node itself.
constexpr uint16_t kNullDevid = 0xFFFD;    ///< The PC or robot of an island.
constexpr uint16_t kNoSeq = 0xFFFF;        ///< Returned by a refused send.

/// Returns whether an id means no single island or mote. (decision 132)
constexpr bool is_reserved(uint16_t id) { return id >= kNullDevid; }

struct Address {
  uint16_t pid;
  uint16_t devid;
};
constexpr bool operator==(Address a, Address b) { return a.pid == b.pid && a.devid == b.devid; }
constexpr bool operator!=(Address a, Address b) { return !(a == b); }

constexpr bool is_broadcast(Address address) {
  return address.pid == kBroadcast || address.devid == kBroadcast;
}

inline rubicon::RAddr wire_of(Address address) {
  rubicon::RAddr wire;
  wire.pid = static_cast<rubicon::Pid>(address.pid);
  wire.devid = static_cast<rubicon::Devid>(address.devid);
  return wire;
}
inline Address address_of(rubicon::RAddrView view) {
  return {static_cast<uint16_t>(view.pid()), static_cast<uint16_t>(view.devid())};
}

/// A mote's description of itself when it joins.
using Descriptor = rubicon::MoteDesc;

enum class Role : uint8_t { kMote, kSink, kBaseStation };
/// PEIS is the line between base stations.
enum class Line : uint8_t { kRadio, kSerial, kPeis };
enum class Mode : uint8_t { kReliable, kPowerSave };
enum class DataStatus : uint8_t { kNew, kOld, kUnknownChannel };
/// Why a node does not send a message of its application.
enum class Refusal : uint8_t {
  kNone,
  kTooLong,    ///< More than kAppDataMax bytes.
  kNotJoined,  ///< It is a mote that is no member.
  kNoWay,      ///< The message is for the node itself, or no line leads to all whom it is for.
  kAwaiting,   ///< As many acks are awaited as can be.
  kOff,        ///< The line is switched off.
  kFull,       ///< The line's outgoing buffer is full.
};

/// Source devid in the upper, destination devid in the lower 16 bits.
using ChannelId = uint32_t;

/// The result of an operation on a channel.
struct ChannelResult {
  ChannelId id;
  bool success;
};
struct InputValue {
  float value;
  bool success;
};

/// Ticks wrap after 48 days; moments are less than half of that apart.
using Ticks = uint32_t;
constexpr bool is_reached(Ticks due, Ticks now) { return static_cast<int32_t>(now - due) >= 0; }

}  // namespace node
}  // namespace rubric
