// Decides which rule a line that was not kept blames, by what the evidence shows.
//
// A line may name several rules. One of them is broken for sure, the others are suspected only.
// Rules of spec/requirements.yaml say what an output that breaks them looks like (shows, differs,
// content): an event is no message that is sent again, an ack none that the application sent. The
// rule that fits best is blamed; of several that fit alike the one that the line names first.
//
// After a node's first failure it is in another state than the case assumes, so that what it breaks
// later in the case proves nothing: such failures are implied by the first.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "conformance/test/runner/run_case.h"

namespace rubric::runner {

class NodeLog;

/// Words for what was seen.
/// - A forbidden output: its link ("radio", "serial", "peis", "app"), its message ("ack" for a
///   net_msg that acks), its result ("success", "fail"), and whether the node emitted it before
///   ("again", "new").
/// - An output that did not come: "missing", and "unused" if nothing at all came on that link.
/// - One that came but is not as the line asks: "differs" and in what ("am", names of fields,
///   "order"), and "ack" if it acks.
using Evidence = std::set<std::string, std::less<>>;

/// Moves the rules of a line that are only suspected from the failure's requirements to
/// `suspected`. A node's own ack that came and differs breaks T2-CONTENT, whatever the line asks it
/// for.
void blame_one(Failure& failure, const Evidence& evidence);

/// Returns whether a break of the rule looks like this.
bool shows(std::string_view rule, const Evidence& evidence);

/// Marks the failures of each node that its first one implies. Failures are in the order in which
/// the lines were broken.
void mark_implied(std::vector<Failure>& failures);

/// Marks implied failures, and adds one for outputs that are longer than their message: patterns
/// compare fields and do not see what is behind them. Such a failure implies no other, since the
/// node is in the state that the case assumes. `place` is that of outputs which no line took.
void conclude(CaseResult& result, const std::vector<NodeLog>& nodes, trace::Place place);

}  // namespace rubric::runner
