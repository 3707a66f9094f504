#include "conformance/adapters/cpp/base_station.h"

#include "codec/generated/rubicon/config.h"

namespace rubric::cpp_node {

BaseStation::BaseStation(const Settings& settings, World& world)
    : Node(settings, 0, world), island_(settings.island) {}

bool BaseStation::is_for_me(Line line, const Frame& frame) const {
  if (line == Line::kPeis) return frame.dest == island_ || frame.dest == kAll;
  return line == Line::kSerial;
}

bool BaseStation::set_island(std::uint16_t island) {
  if (is_reserved(island)) return false;
  rubicon::Config config;
  config.type = rubicon::CommandCode::kSetIslandId;
  config.value = island;
  if (!line(Line::kSerial).push({kSinkDevice, 0, AmType::kConfig, bytes_of(config)})) return false;
  island_ = island;
  return true;
}

bool BaseStation::route(const Message& message) {
  const std::uint16_t island = message.dest.island;
  if (island == kAll) return false;  // No line reaches every island.
  if (island == island_) {
    return line(Line::kSerial).push({kSinkDevice, 0, AmType::kNet, write_message(message, true)});
  }
  //= N8-PEIS: A base station sends a message for another island, its own or its sink's, through
  //= PEIS to that island's base station.
  return line(Line::kPeis).push({island, island_, AmType::kNet, write_message(message)});
}

void BaseStation::message(Line from, const Message& message) {
  const Address dest = message.dest;
  const bool own_island = dest.island == island_;
  //= N8-DELIVER: A base station delivers a message with dest <its island, NULL> to its application.
  if (own_island && dest.device == kNull) return deliver(message);
  if (dest.island == kAll) return;
  // Down from another island, or up from the sink; never back to where it came from.
  if (own_island == (from == Line::kPeis)) route(message);
}

}  // namespace rubric::cpp_node
