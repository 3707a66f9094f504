// A way through the network as a trace that people read and the offline checker judges.
#pragma once

#include <string>

#include "conformance/explorer/search.h"
#include "conformance/trace/trace.h"

namespace rubric::explorer {

/// What the trace says about itself.
struct Title {
  std::string profile;    ///< "paper" or "deployed".
  std::string case_name;  ///< As `explore.one_terminal`.
  std::string note;       ///< For the head; may be empty.
};

/// Walks the path on fresh nodes with a clock that runs: a timer fires when it is due, or later
/// where something else had to happen before, and what is heard takes two ticks. Ends with a
/// question for a node's clock long after, so that what did not happen can be seen.
trace::File counterexample(Nodes& nodes, const Path& path, const Title& title);

}  // namespace rubric::explorer
