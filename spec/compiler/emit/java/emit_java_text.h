// Prints names, numbers and expressions for the Java emitter, and its parts.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "spec/compiler/emit/cpp/emit_cpp_layout.h"

namespace rubricc::java {

using cpp::FieldLayout;
using cpp::Group;
using cpp::Layout;
using cpp::Shape;

/// "net_msg" becomes "NetMsg"; "String_" if Java or the common classes have the name.
std::string class_name(std::string_view id);
/// "seq_num" becomes "seqNum"; "byte_" if it is a word of Java or a member of each view.
std::string member(std::string_view id);
/// "payload" becomes "prefixPayload".
std::string member_with(std::string_view prefix, std::string_view id);
/// "set_island_id" becomes "SET_ISLAND_ID".
std::string constant(std::string_view id);
/// Returns a structure's class as seen from `spec`: "RAddr" or "rubric.wire.tinyos.AmHeader".
std::string class_of(const Type& type, const Spec& spec);
std::string class_of(const Enum& e, const Spec& spec);
/// Returns "rubric.wire.rubicon".
std::string package_of(const Spec& spec);

/// Returns a string literal.
std::string quote(std::string_view text);
/// Returns an integer literal: with L if int does not hold it.
std::string literal(std::int64_t value);
/// Returns a key of a switch, which is an int.
std::string key_literal(std::int64_t value);
/// Returns a documentation comment in lines of at most 100 columns at `indent`.
std::string javadoc(std::string_view prose, std::size_t indent);

/// Returns "u2be", "s1", "f4le": the number's name in Wire, WireReader and WireOutput.
std::string wire_name(const Field& field);
/// Returns "int", "long" or "float".
std::string number_type(const Field& field);

/// Prints `expr`; `leaf` prints its fields. Arithmetic is that of long.
using Leaf = std::function<std::string(const Expr& field)>;
std::string print(const Expr& expr, const Leaf& leaf);
/// Prints, as an int, a number of bytes or elements, times `unit`.
std::string print_size(const Expr& expr, const Leaf& leaf, std::uint32_t unit = 1);
/// Prints fields of a structure whose bytes are the buffer `bytes` from `base` on.
Leaf loads_from(const std::string& bytes, const std::string& base = "");

/// Returns `statements` as the body of an `if`.
std::string in_if(const std::string& condition, const std::string& statements);

/// Describes a field, where its bytes are, and its rules, for a comment.
std::string field_text(const Layout& layout, std::size_t i);

/// Emits the rules of a structure: the body of check().
std::string emit_check(const Layout& layout, const Spec& spec);
/// Emits the getters, sizeBytes() and fields().
std::string emit_getters(const Layout& layout, const Spec& spec);
/// Emits `class Writer`, and toWriter().
std::string emit_writer(const Layout& layout, const Spec& spec);

}  // namespace rubricc::java
