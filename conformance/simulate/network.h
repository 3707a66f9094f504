// A network to simulate: nodes, the lines between them, and the faults of the lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "conformance/machine/state.h"
#include "conformance/simulate/event_queue.h"

namespace rubric::simulate {

class Application;

/// An index into Network::nodes.
using NodeId = std::size_t;

/// Faults of a line, independent of one another.
struct Faults {
  double loss = 0;          ///< Probability that a receiver does not get a frame.
  double duplication = 0;   ///< Probability that it gets it twice.
  Micros delay_max_us = 0;  ///< Up to this much more until it has it.
};

struct NodePlan {
  std::string name;  ///< Unique.
  machine::Config config;
  std::unique_ptr<Application> application;  ///< May be none.
  std::size_t radio = 0;                     ///< Motes and sinks: index into Network::radios.
};

/// Nodes whose radios share the air. All hear one another except for `deaf`.
struct RadioPlan {
  std::string name;  ///< rA
  Faults faults;
  struct Deaf {
    NodeId from = 0;
    NodeId to = 0;  ///< Does not hear `from`: too far away.
  };
  std::vector<Deaf> deaf;
  struct LinkFaults {
    NodeId from = 0;
    NodeId to = 0;
    Faults faults;  ///< In place of the radio's.
  };
  std::vector<LinkFaults> link_faults;
};

/// The serial line between a sink and its base station.
struct SerialPlan {
  std::string name;  ///< serA
  NodeId sink = 0;
  NodeId base_station = 0;
  double loss = 0;  ///< Probability that a frame is destroyed on its way.
};

/// A transmitter that is no node of the layer, such as an RSSI anchor: the same AM payload in
/// broadcasts, again and again.
struct BeaconPlan {
  std::size_t radio = 0;
  std::uint16_t am_address = 0;
  std::uint8_t am_type = 0;
  std::vector<std::uint8_t> payload;
  Micros first_us = 0;
  Micros period_us = 500'000;
};

struct Network {
  std::uint64_t seed = 1;
  std::string profile = "paper";  ///< The name of the nodes' profile.
  std::vector<NodePlan> nodes;
  std::vector<RadioPlan> radios;
  std::vector<SerialPlan> serials;
  std::vector<BeaconPlan> beacons;
  Faults peis;  ///< Between all base stations.
  Micros peis_delay_us = 5'000;
};

}  // namespace rubric::simulate
