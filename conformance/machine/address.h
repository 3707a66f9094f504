// RUBICON addresses and descriptors as plain numbers. (paper: The RUBICON Addressing Scheme)
#pragma once

#include <compare>
#include <cstdint>

namespace rubric::machine {

constexpr std::uint16_t kBroadcastPid = 0xFFFF;
constexpr std::uint16_t kLocalPid = 0xFFFE;  ///< Replaced by the own island before sending.
constexpr std::uint16_t kBroadcastDevid = 0xFFFF;
constexpr std::uint16_t kLocalDevid = 0xFFFE;  ///< The node itself.
constexpr std::uint16_t kNullDevid = 0xFFFD;   ///< Not for a mote: for the island's PC or robot.
constexpr std::uint16_t kAmBroadcast = 0xFFFF;
constexpr std::uint16_t kNoSeq = 0xFFFF;  ///< Returned when send refuses.

/// <pid, devid>: an island and a mote in it.
struct Address {
  std::uint16_t pid = 0;
  std::uint16_t devid = 0;
  friend auto operator<=>(const Address&, const Address&) = default;
};

/// Island ids and devids that name no one island or mote. (decision 132)
constexpr bool is_reserved(std::uint16_t id) { return id >= kNullDevid; }

/// A mote's description of itself when it joins.
struct Descriptor {
  std::uint8_t mote_type = 0;
  std::uint8_t actuators = 0;
  std::uint16_t transducers = 0;
  friend auto operator<=>(const Descriptor&, const Descriptor&) = default;
};

enum class Role : std::uint8_t { kMote, kSink, kBaseStation };

/// A mote has a radio, a sink a radio and a serial line, a base station a serial line and PEIS.
enum class Link : std::uint8_t { kRadio, kSerial, kPeis };

}  // namespace rubric::machine
