// Parses expressions of the profile: text to tree.
#pragma once

#include <string_view>

#include "spec/compiler/diagnostics.h"

namespace rubricc {

/// Returns null after an error. `place` is where the text begins.
ExprPtr parse_expr(std::string_view text, const Place& place, Diagnostics& diagnostics);

/// Returns the tree as text, bracketed only where needed: for diagnostics and the documentation.
std::string to_text(const Expr& expr);

}  // namespace rubricc
