// Reads and prints single values of a trace.
#pragma once

#include <string>
#include <string_view>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Appends the value as a trace writes it.
void put_value(const Value& value, std::string& out);
std::string value_text(const Value& value);

/// Reads one value; returns what is wrong with it, or nothing.
std::string read_value(std::string_view text, Value& out);
/// Returns the size of a value that begins at the first byte: up to a blank, `)` or `]` that is not
/// in quotes or brackets.
std::size_t value_size(std::string_view text);

/// Reads a whole number in decimal or, after 0x, in hex; returns false at anything else and beyond
/// 15 digits.
bool read_integer(std::string_view text, std::int64_t& out);
/// Returns whether it is a letter or `_`, then letters, digits and `_`.
bool is_name(std::string_view text);
/// Returns the same with `-` and `.` inside: names of nodes, links and cases; may begin with a
/// digit.
bool is_dotted_name(std::string_view text);
/// Returns whether it is names joined by dots, each perhaps with an index:
/// "payload.body.updates[0].value".
bool is_path(std::string_view text);

/// Appends the bytes of hex digits, two a byte, without blanks; returns false at anything else.
bool read_hex_bytes(std::string_view digits, std::string& out);
/// Returns a word in single quotes, as diagnostics show it.
std::string quoted(std::string_view text);

/// Appends two hex digits a byte.
void put_hex(std::string_view bytes, std::string& out);

}  // namespace rubric::trace
