// What is known of islands and their motes, and the news of them.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "conformance/check/observation.h"
#include "conformance/machine/address.h"
#include "tools/commands/space/layout.h"
#include "tools/commands/space/space.h"

namespace rubric::monitor {

/// Learns from frames and tuples who is in which island. Its texts are not harmless yet: some are
/// from outside.
class Board {
 public:
  /// A mote of which no frame came for so long is silent; 0: never. A tuple says itself who has
  /// gone.
  explicit Board(std::int64_t silent_ms) : silent_ms_(silent_ms) {}

  /// `now_ms` counts from 1970, here and below.
  void take(const check::Observation& seen, std::int64_t now_ms);
  void take(const space::Tuple& tuple, std::int64_t now_ms);
  /// Adds what somebody else has to say: a finding.
  void add_news(const std::string& text, std::int64_t now_ms);
  /// Finds motes that have become silent.
  void look(std::int64_t now_ms);

  /// Returns the lines of news since the last call, with their times.
  std::vector<std::string> take_news();
  /// Returns a heading and a line for each node, by island, and one for a full table.
  std::vector<std::string> table(std::int64_t now_ms) const;
  /// Returns the last lines of news, at most so many.
  std::vector<std::string> last_news(std::size_t count) const;

 private:
  struct Node {
    std::optional<space::Mote> mote;  // Its description, once it is known.
    std::string readings;
    bool by_space = false;  // Who told them.
    std::int64_t told_ms = 0;
    std::int64_t heard_ms = 0;
    std::uint64_t frames = 0;
    std::uint64_t repeats = 0;
    int joins = 0;
    bool on_line = false;  // A frame showed it, not only tuples.
    bool gone = false;
    std::uint16_t number = 0;  // Of the last message.
    bool has_number = false;
    int dsn = -1;  // Of the last radio frame.
    std::vector<std::uint8_t> payload;
  };
  Node* node(machine::Address address);
  void heard(machine::Address address, Node& node, std::int64_t now_ms);
  void joined(machine::Address address, const machine::Descriptor& descriptor, std::int64_t now_ms);
  void read(machine::Address address, Node& node, const std::string& data, bool by_space,
            std::int64_t now_ms);
  void set_gone(machine::Address address, Node& node, bool gone, const char* why,
                std::int64_t now_ms);

  std::int64_t silent_ms_;
  std::map<machine::Address, Node> nodes_;
  std::uint64_t unlisted_ = 0;             // Frames of nodes for which there was no room.
  std::map<std::uint16_t, bool> islands_;  // Online, as the space has it.
  std::vector<std::string> news_;
  std::deque<std::string> last_;
};

}  // namespace rubric::monitor
