// What the lines of a case's log are about: who takes part, what they are called, what they break.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "conformance/runner/run_case.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {

/// Nodes, as indexes, that a frame's line passes to, or for `<` may come from, as its addresses
/// say; empty for what is no frame. Sinks share an address: of several senders only those stay
/// whose island the message names.
std::vector<std::size_t> peers_of(const std::vector<trace::NodeHeader>& nodes,
                                  const trace::Line& line);

/// The message in a few words: "join_request 7", "ack of 7", "joined success".
std::string short_text(const trace::Message& message);

/// Whether this line of the log is the output that the failure speaks of: one that was forbidden.
bool is_broken_by(const runner::Failure& failure, const trace::Line& line);

/// The golden trace's line that was not kept; nothing where the failure names none.
std::optional<trace::Line> asked_line(const runner::Failure& failure);

constexpr std::size_t kNoLine = std::numeric_limits<std::size_t>::max();
/// For each line the earlier one that shows the same frame: as its sender emitted it, or as another
/// node was given it. kNoLine where it is shown for the first time.
std::vector<std::size_t> first_seen(const std::vector<const trace::Line*>& lines);

}  // namespace rubric::suite
