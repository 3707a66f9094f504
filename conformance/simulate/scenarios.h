// The networks of the paper, and one of any size.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "conformance/simulate/network.h"

namespace rubric::simulate {

struct ScenarioOptions {
  std::uint64_t seed = 1;
  double loss = 0;  ///< Share of lost radio frames at every receiver.
  double duplication = 0;
  std::size_t motes = 3;  ///< For the scenario `free` only.
  std::size_t sinks = 1;
};

struct Scenario {
  const char* name;
  const char* doc;
  Micros length_us;  ///< How long its story takes.
};

/// Returns all scenarios, `free` last.
std::span<const Scenario> scenarios();
/// Returns the scenario of this name, or null.
const Scenario* find_scenario(std::string_view name);
/// Returns the network of a scenario.
Network make_network(const Scenario& scenario, const ScenarioOptions& options);

}  // namespace rubric::simulate
