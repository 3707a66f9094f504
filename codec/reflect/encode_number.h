// Numbers of the encoder: from the given fields to a value, and from there to bytes.
#pragma once

#include <cstdint>
#include <string>

#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"

namespace rubric::reflect {

/// The fields' statement about a number.
struct NumberResult {
  bool present = false;     ///< Given, or the only value that can be meant.
  std::int64_t value = 0;   ///< A float as its 32 bits.
  std::size_t members = 0;  ///< Members of the object that say it ("x" and "x_name": 2).
  std::string problem;      ///< Expected and given; empty if nothing is wrong.
};

/// Returns the value of field `f`, given as `value` (null if missing) beside the names and bits in
/// `object`.
NumberResult number_of(const Field& f, const Value& object, const Value* value);

/// Returns what is wrong with this value for the field, or an empty text.
std::string number_problem(const Field& f, std::int64_t value);

/// Returns what the field takes: "a number from 2 to 102".
std::string expectation(const Field& f);

/// Writes width_bytes bytes.
void store_number(const Field& f, std::int64_t value, std::uint8_t* at);

/// Returns a value as an error message quotes it.
std::string value_text(const Value& value);

}  // namespace rubric::reflect
