// A path through the explorer's network of two motes and two sinks, chosen by bytes.
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/explore/search.h"

namespace rubric::script {

/// Returns options with loss, duplicates, reordering, collisions, a reboot and a second call of
/// each mote, and, in full scope, messages.
explore::Options walk_options(explore::Scope scope, explore::StepFunction step);
/// Returns the scope of a walk, which is in its first byte.
explore::Scope walk_scope(Bytes bytes);

/// The most moves of a walk. Each further byte chooses a successor. The walk ends with the bytes,
/// where there is no successor, after kMovesMax moves, or where a property is broken. `nodes` may
/// have walked before.
constexpr std::size_t kMovesMax = 600;
explore::Path walk(explore::Nodes& nodes, Bytes bytes);

}  // namespace rubric::script
