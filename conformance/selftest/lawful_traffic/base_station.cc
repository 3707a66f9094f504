// A base station.
#include <algorithm>

#include "conformance/selftest/lawful_traffic/node.h"
#include "conformance/selftest/lawful_traffic/serial_line.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr auto kNet = static_cast<std::uint8_t>(rubicon::AmType::kNet);
constexpr std::size_t kNetMsgBytes = 114;

}  // namespace

BaseStation::BaseStation(World& world, int number, std::uint16_t island)
    : Endpoint(world, number, kNull, "base_station") {
  address_ = {island, kNull};
}

void BaseStation::set_island(std::uint16_t island) {
  address_.pid = island;
  line_->to_mote(static_cast<std::uint8_t>(rubicon::AmType::kConfig),
                 config(rubicon::CommandCode::kSetIslandId, island));
}

void BaseStation::raw(std::uint8_t am_type, const Octets& payload) {
  line_->to_mote(am_type, payload);
}

void BaseStation::send_to_sink(const NetMessage& message) {
  Octets bytes = encode(message);
  if (!world_.traits().serial_cut) bytes.resize(kNetMsgBytes);
  line_->to_mote(kNet, bytes);
}

void BaseStation::serial_heard(std::uint8_t am_type, const Octets& payload) {
  if (am_type != kNet) return;
  const auto message = decode_net(view(payload));
  if (!message) return;
  const Traits& traits = world_.traits();
  const auto delay = world_.random().between(traits.delay_min_us, traits.delay_max_us);
  last_work_us_ = std::max(last_work_us_, world_.now_us() + delay);
  world_.scheduler().at(last_work_us_, [this, message = *message] {
    if (message.dest.pid == address_.pid) {
      if (message.dest.devid == kNull) arrived(message);
      return;
    }
    if (world_.traits().hands_foreign_to_sink) send_to_sink(message);
    world_.peis(address_.pid, message);
  });
}

void BaseStation::peis_heard(const NetMessage& message) {
  if (message.dest == address_) return arrived(message);
  send_to_sink(message);
}

bool BaseStation::route(const NetMessage& message) {
  const std::uint16_t pid = message.dest.pid;
  if (pid == address_.pid || pid == kAllNodes) send_to_sink(message);
  if (pid != address_.pid) world_.peis(address_.pid, message);
  return true;
}

}  // namespace rubric::lawful
