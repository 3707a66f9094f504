// Prints names, numbers and expressions for the C++ emitter.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/model.h"

namespace rubricc::cpp {

/// Returns a type's class as seen from `spec`: "RAddr" or "tinyos::AmHeader".
std::string class_of(const Type& type, const Spec& spec);
/// Returns "codec/generated/rubicon/net_msg.h".
std::string header_of(const Type& type);
std::string enums_header_of(const Spec& spec);

/// Returns the C++ type of one number of the field: "uint16_t", "Devid", "TransducerMask", "float".
std::string number_type(const Field& field, const Spec& spec);
/// Returns the unsigned integer of its width: "uint16_t".
std::string raw_type(const Field& field);
/// Returns the class that reads and writes it in arrays: "As<Devid, U16Be>".
std::string wire_number(const Field& field, const Spec& spec);
/// Returns an expression that loads one number of the field at a pointer.
std::string load(const Field& field, const Spec& spec, const std::string& at);
/// Returns the same as a plain integer, for comparisons.
std::string load_integer(const Field& field, const std::string& at);
/// Returns a statement that stores `value` at a pointer.
std::string store(const Field& field, const std::string& at, const std::string& value);

/// Returns "p + 12"; "p" for 0.
std::string plus(const std::string& pointer, const std::string& offset);
/// Returns an integer that compiles without a warning where int has 16 bits.
std::string literal(std::int64_t value);

/// Prints `expr`; `leaf` prints its fields.
using Leaf = std::function<std::string(const Expr& field)>;
std::string print(const Expr& expr, const Leaf& leaf);
/// A structure's bytes as expressions read them: loads from `pointer`, of which `safe` bytes are
/// known to be there; a load after them checks `size` first and gives 0 beyond the end.
struct Source {
  std::string pointer;
  std::string size;
  std::int64_t safe = 0;
};
Leaf loads_from(const Source& source);
/// Prints a number of bytes or elements, times `unit`.
std::string print_size(const Expr& expr, const Leaf& leaf, std::uint32_t unit = 1);
/// Returns the structure's field that is the whole expression; null if it is anything else.
const Field* plain_field(const Expr* expr);

/// Returns `text` as a template argument, whose brackets no template of ours can hold.
std::string angles(const std::string& text);

/// Prints `if (cond) ret` in one line or three; marks unlikely conditions.
std::string guard(const std::string& condition, const std::string& statement, bool unlikely = true);
/// Joins with an operator, in lines of at most 90 columns.
std::string join(const std::vector<std::string>& parts, std::string_view op);
/// Prints prose as comment lines of at most 100 columns at the given indent.
std::string comment(std::string_view prose, std::string_view mark = "///", std::size_t indent = 0);

/// Folds the lines of a whole file to 100 columns: code at operators and commas.
std::string fold(const std::string& text);

}  // namespace rubricc::cpp
