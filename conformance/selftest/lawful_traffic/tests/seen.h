// Helpers of the generator's tests: packets taken apart by their offsets, not by the generator.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "conformance/selftest/lawful_traffic/message.h"
#include "conformance/selftest/lawful_traffic/traffic.h"

namespace rubric::lawful {

struct Seen {
  std::int64_t time_us = 0;
  std::string interface;
  bool radio = false;
  bool inbound = false;   ///< Host to mote.
  bool sum_ok = true;     ///< FCS or CRC.
  bool link_ack = false;  ///< 802.15.4 ACK, or the serial line's ACK.
  std::uint8_t dsn = 0;   ///< Or the serial sequence number.
  std::uint16_t am_dst = 0;
  std::uint16_t am_src = 0;
  int am_type = -1;
  Octets payload;  ///< In the AM frame.
  std::optional<NetMessage> net;

  bool is(rubicon::AmType type) const { return am_type == static_cast<int>(type); }
  bool from(rubicon::AmType type, std::uint16_t src) const {
    return radio && is(type) && am_src == src;
  }
  /// Returns seq_num of the join messages.
  std::uint16_t join_seq() const;
  /// Returns island_addr of a join_reply, dest.pid of an ack_join.
  std::uint16_t join_island() const { return load_be16(payload.data()); }
  std::uint32_t cur_time() const { return load_be32(payload.data() + 4); }
  bool app(rubicon::Component trans) const {
    return net && net->payload[0] == static_cast<std::uint8_t>(trans);
  }
  /// Returns the type byte of a Connectionless body; -1 if there is none.
  int body_type() const;
  bool serial_joined() const { return !radio && !inbound && body_type() == 16; }
  /// Returns the number that a Rubicon ack acknowledges.
  std::uint16_t acked() const;
};

using Frames = std::vector<Seen>;
using Pick = std::function<bool(const Seen&)>;

Frames see(const Traffic& traffic);
Frames pick(const Frames& frames, const Pick& wanted);
std::size_t count(const Frames& frames, const Pick& wanted);
inline bool any(const Frames& frames, const Pick& wanted) { return count(frames, wanted) > 0; }

Frames requests(const Frames& frames, std::uint16_t mote);
Frames replies(const Frames& frames, std::uint16_t mote);
Frames ack_joins(const Frames& frames, std::uint16_t mote);
std::size_t distinct_seqs(const Frames& joins);
/// Returns times between neighbours.
std::vector<std::int64_t> gaps(const Frames& frames);
/// Returns events of that name at that node whose fields contain `part`.
std::vector<AppEvent> events(const Traffic& traffic, int node, const std::string& name,
                             const std::string& part = "");

/// A feature that a variant must show; a table of these covers all.
struct Feature {
  const char* variant;
  bool (*shown)(const Traffic& traffic, const Frames& frames);
};
const std::vector<Feature>& join_features();
const std::vector<Feature>& transport_features();
const std::vector<Feature>& other_features();

}  // namespace rubric::lawful
