// Explains the lines of a case's log: the nodes they concern, their short names, and the rules they
// break.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "conformance/test/runner/run_case.h"
#include "conformance/trace/trace.h"

namespace rubric::suite {

/// Returns the indexes of the nodes that a frame's line passes to, or for `<` may come from, by its
/// addresses; empty if it is no frame. Sinks share an address: of several senders only those count
/// whose island the message names.
std::vector<std::size_t> peers_of(const std::vector<trace::NodeHeader>& nodes,
                                  const trace::Line& line);

/// Returns the message in a few words: "join_request 7", "ack of 7", "joined success".
std::string short_text(const trace::Message& message);

/// Returns whether this line of the log is the forbidden output that the failure is about.
bool is_broken_by(const runner::Failure& failure, const trace::Line& line);

/// Returns the golden trace's line that was not kept; nothing if the failure names none.
std::optional<trace::Line> asked_line(const runner::Failure& failure);

/// Returns ", it came at 4500" for what came too early or too late, else nothing.
std::string elsewhere_text(const runner::Failure& failure);

constexpr std::size_t kNoLine = std::numeric_limits<std::size_t>::max();
/// Returns for each line the earlier one that shows the same frame: as its sender emitted it, or as
/// another node was given it. kNoLine if it is the first. Golden traces hand acks on with a code,
/// in whose place a node may have sent the number alone (decision 108); with `acks_in_any_form`
/// that is the same frame as well.
std::vector<std::size_t> first_seen(const std::vector<const trace::Line*>& lines,
                                    bool acks_in_any_form = false);

}  // namespace rubric::suite
