// Addresses, frames, and the message of the network level.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "codec/generated/rubicon/mote_desc.h"
#include "codec/generated/rubicon/r_addr.h"
#include "codec/runtime/bytes.h"

namespace rubric::cpp_node {

using Ticks = std::uint64_t;  ///< 1/1024 s, since the node's driver began to count.
using Data = std::vector<std::uint8_t>;
using rubicon::AmType;
using rubicon::Component;
using rubicon::MoteDesc;

struct Address {
  std::uint16_t island = 0;
  std::uint16_t device = 0;
  friend bool operator==(const Address&, const Address&) = default;
};

// Islands and devices that mean more or less than one island or one mote.
constexpr std::uint16_t kAll = 0xFFFF;
constexpr std::uint16_t kLocal = 0xFFFE;
constexpr std::uint16_t kNull = 0xFFFD;  ///< As a device: the PC or robot of that island.
constexpr bool is_reserved(std::uint16_t part) { return part >= kNull; }

constexpr std::uint16_t kSinkDevice = 1;
constexpr std::uint16_t kNoNumber = 0xFFFF;  ///< Returned by a refused send.

enum class Line : std::uint8_t { kRadio, kSerial, kPeis };

/// An active message. Over PEIS dest and src are islands.
struct Frame {
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  AmType type = AmType::kNet;
  Data payload;
  bool link_ack = false;  ///< Asks for the radio's own acknowledgement.
};

/// A net_msg: `body` comes after TRANSID and APPID.
struct Message {
  Address dest;
  Address src;
  bool reliable = false;
  std::uint16_t number = 0;
  Component transport = Component::kConnless;
  Component application = Component::kMockup;
  Data body;
};

Address address_of(rubicon::RAddrView view);
rubicon::RAddr wire_of(Address address);

/// Returns the bytes of a generated message that cannot be refused.
template <class Value>
Data bytes_of(const Value& value) {
  Data bytes(sizeof(Value) + 64);
  bytes.resize(write(value, MutableBytes(bytes.data(), bytes.size()))->size());
  return bytes;
}

/// Returns nothing if the bytes break a rule of the wire: such a message is dropped (N11).
std::optional<Message> read_message(Bytes payload);
/// Writes a message; `whole` fills up to the 114 bytes that hosts expect on a serial line.
Data write_message(const Message& message, bool whole = false);

}  // namespace rubric::cpp_node
