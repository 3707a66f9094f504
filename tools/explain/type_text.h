// Describes the tables in words: types, sizes, bounds, expressions.
#pragma once

#include <cstdint>
#include <string>

#include "codec/reflect/schema.h"

namespace rubric::explain {

/// Returns the field of `type` (or of a structure in it) at this offset, as a path; "byte 2" if
/// there is no number. `field` becomes that field, or null.
std::string path_at(const reflect::Type& type, std::int32_t offset, const reflect::Field** field);

/// Returns an expression over the fields of `type`: "trans_id == connless and app_id == mockup".
std::string expr_text(const reflect::Expr& expr, const reflect::Type& type);

/// Returns a field's type: "u16", "f32le[matrix_size]", "r_addr", "bytes[nbytes]", "u16[...]".
std::string type_text(const reflect::Field& field, const reflect::Type& owner);

/// Returns the bytes of a field: "2", "4 * output_size", "rest".
std::string size_text(const reflect::Field& field, const reflect::Type& owner);

/// Returns the bytes of a type: "14", "14 to 114", "from 2".
std::string size_text(const reflect::Type& type);

/// Returns a field's allowed values: "2 to 102", "= 63", "expected 35".
std::string valid_text(const reflect::Field& field);

/// Returns "degC = raw * 0.01 - 40"; empty if a field has no unit.
std::string unit_text(const reflect::Field& field);

/// Returns a number with the enumerator's name, if it has one: "3 (connless)".
std::string key_text(std::int64_t key, const reflect::EnumTable* enumeration);

/// Returns the names of the bits that are set: "light, temp", "bit13" for one without a name;
/// "none".
std::string bits_text(const reflect::MaskTable& mask, std::int64_t value);

/// Returns the first sentence of a doc.
std::string first_sentence(const char* doc);

}  // namespace rubric::explain
