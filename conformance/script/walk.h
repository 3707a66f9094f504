// A path through the explorer's network of two motes and two sinks, chosen by bytes.
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/explorer/search.h"

namespace rubric::script {

/// Returns options with loss, duplicates, reordering, collisions, a reboot and a second call of
/// each mote, and, in full scope, messages.
explorer::Options walk_options(explorer::Scope scope, explorer::StepFunction step);
/// Returns the scope of a walk, which is in its first byte.
explorer::Scope walk_scope(Bytes bytes);

/// The most moves of a walk. Each further byte chooses a successor. The walk ends with the bytes,
/// where there is no successor, after kMovesMax moves, or where a property is broken. `nodes` may
/// have walked before.
constexpr std::size_t kMovesMax = 600;
explorer::Path walk(explorer::Nodes& nodes, Bytes bytes);

}  // namespace rubric::script
