// A base station and the PEIS network between base stations.
#pragma once

#include <cstdint>

#include "conformance/selftest/lawful_traffic/endpoint.h"

namespace rubric::lawful {

class SerialLine;

/// The PC of an island; its applications have the address <island, NULL>.
class BaseStation final : public Endpoint {
 public:
  BaseStation(World& world, int number, std::uint16_t island);

  void connect(SerialLine* line) { line_ = line; }
  void serial_heard(std::uint8_t am_type, const Octets& payload);
  void peis_heard(const NetMessage& message);
  void set_island(std::uint16_t island);
  /// Sends its sink bytes as they are, as a tester would.
  void raw(std::uint8_t am_type, const Octets& payload);
  /// Sends a message to its own sink whatever its destination.
  void send_to_sink(const NetMessage& message);

 protected:
  bool route(const NetMessage& message) override;

 private:
  SerialLine* line_ = nullptr;
  std::int64_t last_work_us_ = 0;  ///< Arrivals are handled in order.
};

}  // namespace rubric::lawful
