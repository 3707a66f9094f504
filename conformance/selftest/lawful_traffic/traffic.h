// The generator's output: packets as capture files hold them, and the truth about them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric::lawful {

/// A packet as a capture holds it. On `radio` (link type 195) the record is a frame with FCS and
/// the time its start; on `serial:ID` (link type 147) it is a frame from the kind byte to the CRC,
/// unescaped, and the time its end; kInbound is host to mote.
struct LawfulPacket {
  std::int64_t time_us = 0;
  std::string interface;
  std::uint16_t link_type = 0;
  Direction direction = Direction::kUnknown;
  std::vector<std::uint8_t> record;
};
inline bool operator==(const LawfulPacket& a, const LawfulPacket& b) {
  return a.time_us == b.time_us && a.interface == b.interface && a.link_type == b.link_type &&
         a.direction == b.direction && a.record == b.record;
}

enum class Role : std::uint8_t {
  kMote,
  kSink,
  kBaseStation,
  kTester,    ///< Sends what no correct node sends; not itself judged.
  kOutsider,  ///< A node of other protocols.
};

struct NodeInfo {
  int number = 0;  ///< From the interface's name; a base station has its sink's.
  Role role = Role::kMote;
  std::uint16_t id = 0;      ///< TinyOS id, which is the AM address and the devid.
  std::uint16_t island = 0;  ///< Joined or served at the start; 0 for none.
};

/// An event at an application.
struct AppEvent {
  std::int64_t time_us = 0;
  int node = 0;
  std::uint16_t tos_id = 0;
  std::string role;
  std::string name;
  std::string fields;  ///< JSON members, each with a comma in front.
};

/// The worst verdict that an honest judge may give. Weak: a SHOULD is not followed.
enum class Worst : std::uint8_t { kPass, kWeak };

/// One run of a network.
struct Traffic {
  std::string variant;                ///< As requested.
  std::vector<std::string> variants;  ///< Contained variants; several for `mixed`.
  std::string stated;                 ///< Parameters, as `join_period=300`; else empty.
  std::vector<int> decisions;         ///< Decisions of spec/decisions that it shows readings of.
  std::uint64_t seed = 0;
  Worst worst = Worst::kPass;
  bool sniffer_complete = true;
  bool cold_start = true;
  bool has_radio = true;
  bool has_serial = true;
  bool all_well_formed = true;  ///< False: a tester or noise made malformed packets.
  std::vector<NodeInfo> nodes;
  std::vector<LawfulPacket> packets;  ///< In order of time.
  std::vector<AppEvent> events;       ///< In order of time, of the whole run.
};

}  // namespace rubric::lawful
