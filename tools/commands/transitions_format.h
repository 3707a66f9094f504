// Prints the state diagrams of rubric explore --transitions.
#pragma once

#include <string>
#include <vector>

#include "conformance/explore/transitions.h"

namespace rubric::tools {

/// Returns the diagrams as text for people, as JSON (rubric.transitions/1, explore_format.md), or
/// in the language of Graphviz. `flaw` may be empty.
std::string transitions_text(const std::vector<explore::Diagram>& diagrams);
std::string transitions_json(const std::vector<explore::Diagram>& diagrams,
                             const std::string& profile, const std::string& flaw);
std::string transitions_dot(const std::vector<explore::Diagram>& diagrams);

}  // namespace rubric::tools
