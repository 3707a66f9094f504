// Property: no path through a network of two motes and two sinks, with loss, duplicates,
// reordering, collisions and reboots, breaks a property of the explorer.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "conformance/explorer/network.h"
#include "conformance/script/walk.h"
#include "fuzz/support/require.h"

namespace {

constexpr std::size_t kMemoryMax = std::size_t{256} << 20;

// Remembers the nodes' steps from input to input: a step costs more than a lookup.
rubric::explorer::Nodes& nodes_for(rubric::explorer::Scope scope) {
  static std::array<std::unique_ptr<rubric::explorer::Nodes>, 2> kept;
  auto& nodes = kept[static_cast<std::size_t>(scope)];
  if (!nodes || nodes->full() || nodes->memory_bytes() > kMemoryMax) {
    nodes = std::make_unique<rubric::explorer::Nodes>(
        rubric::script::walk_options(scope, rubric::machine::step));
  }
  return *nodes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubric;
  const Bytes bytes(data, size);
  const explorer::Path path = script::walk(nodes_for(script::walk_scope(bytes)), bytes);
  for (const explorer::PropertyInfo& property : explorer::properties()) {
    const bool broken = (path.violated & explorer::bit(property.property)) != 0;
    fuzz::require(!broken, property.sentence);
  }
  return 0;
}
