#include "conformance/selftest/scripts/walk.h"

#include "conformance/generated/profiles.h"

namespace rubric::script {

explore::Options walk_options(explore::Scope scope, explore::StepFunction step) {
  explore::Options options{.profile = machine::kPaper, .step = step, .scope = scope};
  options.motes = options.sinks = 2;
  options.loss = options.dup = options.reorder = options.collide = true;
  options.reboots = 1;
  options.calls = 2;
  options.sends = 2;
  return options;
}

explore::Scope walk_scope(Bytes bytes) {
  const bool full = !bytes.empty() && bytes[0] % 2 == 1;
  return full ? explore::Scope::kFull : explore::Scope::kJoin;
}

explore::Path walk(explore::Nodes& nodes, Bytes bytes) {
  explore::Network network(nodes);
  explore::Successors ways;
  explore::World world = network.initial();
  explore::Path path;
  const explore::Mask properties = nodes.options().properties;
  for (std::size_t at = 1; !nodes.full(); ++at) {
    network.successors(world, ways);
    path.violated = network.violated(world, ways) & properties;
    if (path.violated != 0 || ways.size() == 0 || at >= bytes.size()) break;
    if (path.moves.size() == kMovesMax) break;
    std::size_t choice = bytes[at];
    if (ways.size() > 256 && at + 1 < bytes.size()) choice = choice << 8 | bytes[++at];
    const explore::Successor& next = ways[choice % ways.size()];
    path.moves.push_back(next.move);
    world = next.world;
    path.violated = next.violated & properties;
    if (path.violated != 0) break;
  }
  return path;
}

}  // namespace rubric::script
