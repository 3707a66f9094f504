// Messages of the protocol as this generator handles them, and their bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "codec/generated/rubicon/all.h"

namespace rubric::lawful {

using Octets = std::vector<std::uint8_t>;

inline constexpr std::uint16_t kAllNodes = 0xFFFF;  ///< Broadcast as pid, devid or AM address.
inline constexpr std::uint16_t kNull = 0xFFFD;      ///< devid of a PC or robot.
inline constexpr std::uint16_t kSinkAm = 1;         ///< AM address and devid of every sink.
inline constexpr std::uint16_t kNoSeq = 0xFFFF;     ///< Returned when send refuses.
inline constexpr std::uint8_t kUnknownApp = 77;     ///< An APPID that names no application.

struct Address {
  std::uint16_t pid = 0;
  std::uint16_t devid = 0;
};
inline bool operator==(Address a, Address b) { return a.pid == b.pid && a.devid == b.devid; }

struct NetMessage {
  Address dest;
  Address src;
  bool reliable = false;
  std::uint16_t seq = 0;
  Octets payload;  ///< TRANSID, APPID and the application's bytes.
};

struct Descriptor {
  std::uint8_t type = 1;
  std::uint16_t transducers = 0x0043;
  std::uint8_t actuators = 1;
};

inline Bytes view(const Octets& octets) { return Bytes(octets.data(), octets.size()); }

Octets encode(const NetMessage& message);
/// Returns nothing if the codec finds a fault.
std::optional<NetMessage> decode_net(Bytes bytes);

Octets join_request(std::uint16_t seq, const Descriptor& descriptor);
Octets join_reply(Address address, std::uint32_t cur_time_ms, std::uint16_t seq);
Octets ack_join(Address sink, Address mote, std::uint16_t seq, const Descriptor& descriptor);
Octets config(rubicon::CommandCode code, std::uint16_t value);

/// Returns TRANSID, APPID and `body`.
Octets app_msg(rubicon::Component trans, std::uint8_t app, const Octets& body);
Octets updates_body(const std::vector<std::pair<std::uint16_t, std::uint16_t>>& pairs);
Octets demo_body(std::uint16_t transducers, std::uint16_t period_ms);
Octets demo_data_body(std::uint16_t reading);
Octets ack_body_deployed(std::uint16_t seq);
Octets ack_body_paper(std::uint16_t seq);
Octets synaptic_body(const std::vector<float>& values);
Octets serial_joined_body(Address mote, const Descriptor& descriptor);

}  // namespace rubric::lawful
