// Expressions of the profile: text to tree.
#pragma once

#include <string_view>

#include "spec/compiler/diagnostics.h"

namespace rubricc {

/// Null after an error. `place` is where the text begins.
ExprPtr parse_expr(std::string_view text, const Place& place, Diagnostics& diagnostics);

/// The tree as text, fully bracketed only where needed: for diagnostics and the documentation.
std::string to_text(const Expr& expr);

}  // namespace rubricc
