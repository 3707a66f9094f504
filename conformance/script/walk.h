// A way through the explorer's network of two motes and two sinks, chosen by bytes.
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/explorer/search.h"

namespace rubric::script {

/// Loss, duplicates, reordering, collisions, a reboot and a second call of each mote, and after
/// that, in full scope, messages.
explorer::Options walk_options(explorer::Scope scope, explorer::StepFunction step);
/// The scope of a walk stands in its first byte.
explorer::Scope walk_scope(Bytes bytes);

/// Each further byte chooses one of the ways on. The walk ends with the bytes, where there is no
/// way on, after kMovesMax moves, or where a property is broken. `nodes` may have walked before.
constexpr std::size_t kMovesMax = 600;
explorer::Path walk(explorer::Nodes& nodes, Bytes bytes);

}  // namespace rubric::script
