// The parts of a node whose transitions are drawn: their states, and what can happen to them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conformance/explorer/transitions.h"
#include "conformance/trace/trace.h"

namespace rubric::explorer {

/// What makes a part go on, as it is drawn.
struct Trigger {
  std::string name;
  std::string guard;  ///< Empty: none.
};

/// One part: a view of a node's state, and what shows all of it.
struct PartInfo {
  const char* name;
  const char* title;
  std::vector<std::string> states;
  bool (*concerns)(const machine::Config& config);
  std::size_t (*state_of)(const machine::State& state);
  /// Nothing: the event has nothing to do with the part.
  std::optional<Trigger> (*trigger_of)(const machine::State& before, const Given& given);
  /// The networks that show the part; or null, and what a sink is given that shows it alone.
  std::vector<Options> (*networks)(const machine::Profile& profile);
  std::vector<Given> (*alphabet)(const machine::Profile& profile);
};

PartInfo synaptic_output();
PartInfo synaptic_input();

/// All parts, each with a name of its own, in the order in which they are drawn; they live as long
/// as the program.
std::span<const PartInfo> parts();
/// Null: there is none of that name.
const PartInfo* find_part(std::string_view name);

/// A frame of the radio as a trace has it.
trace::Message message_of(const machine::Transmit& frame);

}  // namespace rubric::explorer
