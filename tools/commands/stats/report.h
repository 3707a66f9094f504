// Prints the counters for people and for programs.
#pragma once

#include <string>

#include "tools/commands/stats/counters.h"

namespace rubric::stats {

/// Returns aligned tables.
std::string text_report(const Counters& counters);

/// Returns one JSON object, schema "rubric.stats/1".
std::string json_report(const Counters& counters);

}  // namespace rubric::stats
