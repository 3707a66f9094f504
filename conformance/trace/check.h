// Checks beyond the grammar: names that exist, values that fit, labels and variables that are
// defined before their use.
#pragma once

#include <string>
#include <vector>

#include "conformance/trace/parse.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Adds everything that is wrong with the file of `parsed` to its diagnostics.
void check(Parsed& parsed);
/// Checks a file that was built in code; returns nothing if it is right.
std::vector<Diagnostic> check(const File& file);

/// Adds a diagnostic; beyond kDiagnosticsMax it only counts.
void add_diagnostic(Parsed& parsed, Place place, std::string text);

}  // namespace rubric::trace
