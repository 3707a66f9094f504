// The parts of a node whose transitions are drawn: their states and triggers.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conformance/explore/transitions.h"
#include "conformance/trace/trace.h"

namespace rubric::explore {

/// A trigger of a transition, as it is drawn.
struct Trigger {
  std::string name;
  std::string guard;  ///< Empty: none.
};

/// One part: a view of a node's state, and the networks that show all of it.
struct PartInfo {
  const char* name;
  const char* title;
  std::vector<std::string> states;
  bool (*concerns)(const machine::Config& config);
  std::size_t (*state_of)(const machine::State& state);
  /// Returns the trigger; nothing if the event does not concern the part.
  std::optional<Trigger> (*trigger_of)(const machine::State& before, const Given& given);
  /// Returns the networks that show the part; null if instead a sink alone, given these inputs,
  /// shows it.
  std::vector<Options> (*networks)(const machine::Profile& profile);
  std::vector<Given> (*alphabet)(const machine::Profile& profile);
};

/// Returns all parts, with unique names, in the order in which they are drawn; they live as long as
/// the program.
std::span<const PartInfo> parts();
/// Returns the part of that name, or null.
const PartInfo* find_part(std::string_view name);

/// Returns a frame of the radio as a trace has it.
trace::Message message_of(const machine::Transmit& frame);

}  // namespace rubric::explore
