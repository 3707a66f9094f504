// Property: no path through a network of two motes and two sinks, with loss, duplicates,
// reordering, collisions and reboots, breaks a property of the explorer.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "conformance/explore/network.h"
#include "conformance/selftest/scripts/walk.h"
#include "fuzz/support/require.h"

namespace {

constexpr std::size_t kMemoryMax = std::size_t{256} << 20;

// Remembers the nodes' steps from input to input: a step costs more than a lookup.
rubric::explore::Nodes& nodes_for(rubric::explore::Scope scope) {
  static std::array<std::unique_ptr<rubric::explore::Nodes>, 2> kept;
  auto& nodes = kept[static_cast<std::size_t>(scope)];
  if (!nodes || nodes->full() || nodes->memory_bytes() > kMemoryMax) {
    nodes = std::make_unique<rubric::explore::Nodes>(
        rubric::script::walk_options(scope, rubric::machine::step));
  }
  return *nodes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubric;
  const Bytes bytes(data, size);
  const explore::Path path = script::walk(nodes_for(script::walk_scope(bytes)), bytes);
  for (const explore::PropertyInfo& property : explore::properties()) {
    const bool broken = (path.violated & explore::bit(property.property)) != 0;
    fuzz::require(!broken, property.sentence);
  }
  return 0;
}
