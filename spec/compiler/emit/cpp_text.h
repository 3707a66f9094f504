// Pieces of C++ text that the emitters share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc {

/// Turns "net_msg" and "NET-MSG" into "NetMsg".
std::string pascal(std::string_view id);
/// Returns "kNetMsg".
std::string cpp_constant(std::string_view id);
/// How C++ names a rule: `"J4-SEQ"_rule`; `ReqId::kNone` for an empty id.
std::string cpp_rule(const std::string& id);

/// Returns a string literal with everything escaped; never ends a comment or starts a trigraph.
std::string cpp_string(std::string_view text);
/// Returns the same in pieces, each literal at most `width` columns.
std::vector<std::string> cpp_string_pieces(std::string_view text, std::size_t width);

/// Returns `words` joined by ", " in lines of at most 100 columns, every line indented by `indent`.
std::string wrap(const std::vector<std::string>& words, std::size_t indent);

/// Returns an integer literal whose type holds it in C++14: "-1", "4294967295".
std::string cpp_int(std::int64_t value);

/// Returns an operator of two sides as C++ and Java write it: "<=". Throws std::logic_error for any
/// other.
std::string_view infix(ExprOp op);
inline bool is_arithmetic(ExprOp op) { return op >= ExprOp::kAdd && op <= ExprOp::kMod; }

/// Returns `#include "path"`.
std::string cpp_include(std::string_view path);

/// Returns the two lines that begin every generated file, each after `comment`.
std::string banner(std::string_view comment, std::string_view inputs);

using Holes = std::vector<std::pair<std::string_view, std::string>>;

/// Replaces each `<<name>>` of `text` by its value. A value with line breaks is indented like the
/// hole if the hole is alone on its line; a hole alone on its line whose value is empty takes the
/// line with it, but only `<<name?>>` can be empty. Throws std::logic_error for a hole without a
/// value, a value without a hole, and an empty value of a hole without `?`.
std::string fill(std::string_view text, const Holes& holes);

}  // namespace rubricc
