// What a grammar cannot say: names that exist, values that fit, labels and variables that come
// before their use.
#pragma once

#include <string>
#include <vector>

#include "conformance/trace/parse.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Adds to the diagnostics of `parsed` whatever is wrong with its file.
void check(Parsed& parsed);
/// Of a file that was built in code; empty where nothing is wrong.
std::vector<Diagnostic> check(const File& file);

/// Bounded: beyond kDiagnosticsMax it only counts.
void add_diagnostic(Parsed& parsed, Place place, std::string text);

}  // namespace rubric::trace
