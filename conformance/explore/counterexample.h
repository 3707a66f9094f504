// Prints a path through the network as a trace that people read and the offline checker judges.
#pragma once

#include <string>

#include "conformance/explore/search.h"
#include "conformance/trace/trace.h"

namespace rubric::explore {

/// Titles in the trace.
struct Title {
  std::string profile;    ///< "paper" or "deployed".
  std::string case_name;  ///< For example `explore.one_terminal`.
  std::string note;       ///< For the head; may be empty.
};

/// Walks the path on fresh nodes with a clock that runs: a timer fires when it is due, or later if
/// something else had to happen before, and a hearing takes two ticks. Ends with a question for a
/// node's clock long after, so that the trace shows what did not happen.
trace::File counterexample(Nodes& nodes, const Path& path, const Title& title);

}  // namespace rubric::explore
