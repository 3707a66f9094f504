// The messages of the protocol as plain values, read without judging them.
#pragma once

#include <cstdint>
#include <cstring>

#include "codec/generated/rubicon/enums.h"
#include "codec/runtime/bytes.h"
#include "conformance/machine/address.h"
#include "conformance/machine/event.h"
#include "conformance/machine/messages.h"

namespace rubric::oracle {

namespace am = machine::am;
namespace component = machine::component;

constexpr std::size_t kNetHeaderBytes = 12;
constexpr std::uint8_t kNetPayloadMax = 102;

/// A net_msg. It is `sound` (N11) if nbytes is 2 to 102 and no more than the bytes that came.
struct Net {
  machine::Address dest;
  machine::Address src;
  std::uint8_t reliable = 0;
  std::uint8_t nbytes = 0;
  std::uint16_t seq_num = 0;
  bool sound = false;
  std::uint8_t trans_id = 0;  ///< Valid if sound.
  std::uint8_t app_id = 0;
  Bytes payload;              ///< nbytes of it where sound, else what came.
  Bytes body() const { return payload.from(2); }

  bool is_ack() const { return sound && trans_id == component::kRubiconAck; }
  bool broadcast() const {
    return dest.pid == machine::kBroadcastPid || dest.devid == machine::kBroadcastDevid;
  }
  /// Returns both addresses, which with the number identify a message.
  std::uint64_t addresses() const {
    return std::uint64_t{dest.pid} << 48 | std::uint64_t{dest.devid} << 32 |
           std::uint64_t{src.pid} << 16 | src.devid;
  }
};

/// Reads a net_msg. Returns false if it is shorter than a header.
inline bool parse_net(Bytes bytes, Net& out) {
  if (bytes.size() < kNetHeaderBytes) return false;
  const std::uint8_t* const p = bytes.data();
  out.dest = {load_be16(p), load_be16(p + 2)};
  out.src = {load_be16(p + 4), load_be16(p + 6)};
  out.reliable = p[8];
  out.seq_num = load_be16(p + 9);
  out.nbytes = p[11];
  out.payload = bytes.from(kNetHeaderBytes);
  out.sound = out.nbytes >= 2 && out.nbytes <= kNetPayloadMax && out.nbytes <= out.payload.size();
  if (out.sound) {
    out.payload = out.payload.first(out.nbytes);
    out.trans_id = out.payload[0];
    out.app_id = out.payload[1];
  }
  return true;
}

/// Returns whether addresses, reliable, number and payload are the same.
inline bool same_message(const Net& a, const Net& b) {
  return a.addresses() == b.addresses() && a.seq_num == b.seq_num && a.reliable == b.reliable;
}
inline bool same_payload(const Net& a, const Net& b) {
  return a.nbytes == b.nbytes && equal(a.payload, b.payload);
}

inline machine::Descriptor parse_descriptor(const std::uint8_t* p) {
  return {p[0], p[3], load_be16(p + 1)};
}

/// Returns whether both are the same message of one sender on one link, whatever follows its
/// content: an underlying buffer may be longer.
inline bool same_content(const machine::Frame& a, const machine::Frame& b) {
  if (a.src != b.src || a.type != b.type) return false;
  Net one;
  Net other;
  const bool sound = a.type == am::kNet && parse_net(a.payload, one) && one.sound &&
                     parse_net(b.payload, other) && other.sound;
  return sound ? same_message(one, other) && same_payload(one, other)
               : equal(a.payload, b.payload);
}

struct Request {
  std::uint16_t seq_num = 0;
  machine::Descriptor descriptor;
};
inline bool parse_request(Bytes bytes, Request& out) {
  if (bytes.size() < 6) return false;
  out = {load_be16(bytes.data()), parse_descriptor(bytes.data() + 2)};
  return true;
}

struct Reply {
  std::uint16_t island = 0;
  std::uint16_t mote = 0;
  std::uint32_t time_ms = 0;
  std::uint16_t seq_num = 0;
};
inline bool parse_reply(Bytes bytes, Reply& out) {
  if (bytes.size() < 10) return false;
  const std::uint8_t* const p = bytes.data();
  out = {load_be16(p), load_be16(p + 2), load_be32(p + 4), load_be16(p + 8)};
  return true;
}

struct AckJoin {
  machine::Address dest;
  machine::Address src;
  std::uint16_t seq_num = 0;
  machine::Descriptor descriptor;
  friend bool operator==(const AckJoin&, const AckJoin&) = default;
};
inline bool parse_ack_join(Bytes bytes, AckJoin& out) {
  if (bytes.size() < 14) return false;
  const std::uint8_t* const p = bytes.data();
  out.dest = {load_be16(p), load_be16(p + 2)};
  out.src = {load_be16(p + 4), load_be16(p + 6)};
  out.seq_num = load_be16(p + 8);
  out.descriptor = parse_descriptor(p + 10);
  return true;
}

/// serial_joined within a sound net_msg of CONNLESS, CONTROL_LAYER.
struct SerialJoined {
  machine::Address address;
  machine::Descriptor descriptor;
};
inline bool parse_serial_joined(const Net& net, SerialJoined& out) {
  constexpr auto kControl = static_cast<std::uint8_t>(rubicon::Component::kControlLayer);
  constexpr auto kJoined = static_cast<std::uint8_t>(rubicon::AmType::kSerialJoined);
  if (!net.sound || net.trans_id != component::kConnless || net.app_id != kControl) return false;
  const Bytes body = net.body();
  if (body.size() < 9 || body[0] != kJoined) return false;
  const std::uint8_t* const p = body.data();
  out.address = {load_be16(p + 1), load_be16(p + 3)};
  out.descriptor = parse_descriptor(p + 5);
  return true;
}

/// Returns the island id of a SET_ISLAND_ID config message; -1 for another message, or an id that
/// no sink can have.
inline std::int32_t set_island_id(const machine::Frame& frame) {
  if (frame.type != am::kConfig || frame.payload.size() < 3) return -1;
  constexpr auto kSet = static_cast<std::uint8_t>(rubicon::CommandCode::kSetIslandId);
  const std::uint16_t island = load_be16(frame.payload.data() + 1);
  const bool usable = island != machine::kLocalPid && island != machine::kBroadcastPid;
  return frame.payload[0] == kSet && usable ? island : -1;
}

}  // namespace rubric::oracle
