// What the tuples of islands are called and what is in them, as spec/space/README.md has it.
// Everything that is read here may come from anybody.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/machine/event.h"
#include "tools/commands/space/space.h"

namespace rubric::space {

constexpr std::size_t kPayloadMax = 4096;  ///< Longer ones are refused.

// Keys.

std::string net_key(std::uint16_t island);  ///< Of all islands for 0xFFFF.
std::string island_availability_key(std::uint16_t island);
std::string events_key(std::uint16_t island);
std::string mote_key(std::uint16_t island, std::uint16_t mote);
std::string state_key(std::uint16_t island, std::uint16_t mote);
std::string availability_key(std::uint16_t island, std::uint16_t mote);

/// The parts of a key of this layout.
struct Key {
  enum class Kind : std::uint8_t {
    kNet,
    kIslandAvailability,
    kEvents,
    kMote,
    kState,
    kAvailability,
    kSet,
  };
  Kind kind = Kind::kNet;
  std::uint16_t island = 0;  ///< 0xFFFF for the net of all islands.
  std::uint16_t mote = 0;
};
/// Returns nothing for other keys.
std::optional<Key> parse_key(std::string_view key);

// Payloads of a broker: the data with who wrote them and when.

std::string payload_of(const Tuple& tuple);
/// Fills creator, time and data. Returns what is wrong; empty if nothing is.
std::string parse_payload(std::string_view payload, Tuple& tuple);
/// "2026-01-31T23:59:59.123Z"
std::string time_text(std::int64_t ms);

// Data.

std::string availability_data(bool online);

/// The data of a net: a net_msg as the active message that base stations exchange.
std::string net_data(Bytes packet);
/// Returns the packet from its dispatch byte on. Returns what is wrong; empty if nothing is.
std::string parse_net(const Tuple& tuple, std::vector<std::uint8_t>& packet);

struct Mote {
  machine::Descriptor descriptor;
  std::int64_t joined_ms = 0;
};
std::string mote_data(const Mote& mote);
std::string parse_mote(const std::string& data, Mote& mote);

/// Returns the readings in a message of the control layer or of the demo; empty if it has none.
std::string state_data(const Mote& mote, std::uint8_t app_id, Bytes data);

/// What somebody asks of a mote.
struct Wish {
  std::string id;  ///< Given back in events; empty: none.
  std::uint8_t app_id = 0;
  bool reliable = true;
  std::uint16_t transducers = 0;  ///< Whose readings are asked for.
  std::vector<std::uint8_t> data;
};
std::string parse_wish(const std::string& data, Wish& wish);

/// An event of a wish: sent, done, failed, refused, with what more there is to say.
std::string wish_event(const char* what, std::uint16_t mote, const std::string& id,
                       const std::string& why);

// Home Assistant's discovery.

struct Announcement {
  std::string topic;
  std::string payload;
};
/// Returns the topic at which a sensor of a mote is described; nothing there: there is none.
std::string sensor_topic(std::uint16_t island, std::uint16_t id, const std::string& sensor);
/// Returns what makes a home's controller show each sensor of a mote. `root` is that of the topics.
std::vector<Announcement> home_assistant(const std::string& root, std::uint16_t island,
                                         std::uint16_t id, const Mote& mote);

}  // namespace rubric::space
