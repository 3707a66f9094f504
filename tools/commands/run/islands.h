// Runs a whole ecology in one process.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "conformance/trace/trace.h"
#include "tools/commands/run/ecology.h"
#include "tools/commands/run/keeper.h"
#include "tools/commands/run/line_output.h"

namespace rubric::run {

/// Returns the nodes of an ecology as its log names them.
std::vector<trace::NodeHeader> nodes_of(const Ecology& ecology);

/// Runs its nodes, each in a thread, until stop_requested() or `events`, which take those of all
/// nodes with their names, cannot be written. `credentials` is the file of an MQTT space, or empty.
/// Throws Broken, std::invalid_argument or std::system_error if something cannot be had.
void run_ecology(const Ecology& ecology, const std::string& credentials, Keeper& keeper,
                 std::shared_ptr<LineOutput> events);

}  // namespace rubric::run
