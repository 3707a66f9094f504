// From what a message says of its fields to single values: variables, other values for `!x`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "conformance/trace/concrete.h"
#include "conformance/trace/schema.h"

namespace rubric::trace {

/// The value with variables replaced. Throws TraceError at `*`, at a range and at a variable that
/// nothing has bound.
Value substituted(const Value& value, const Bindings& bindings, Place place);

/// The number that the value means in this domain, a real as its 32 bits; with `!` another one.
std::int64_t number_in(const Domain& domain, const Value& value, Place place);
/// The bytes of hex or text; with `!` other bytes.
std::string bytes_in(const Value& value, Place place);

/// The field by its whole path, if it is positional too; `position` counts those. Throws TraceError
/// where a path leads nowhere or to several fields, and where there are too many positional ones.
FieldValue with_path(const FieldValue& field, const Shape& shape, std::size_t& position);
/// All fields of a message.
std::vector<FieldValue> with_paths(const Message& message, const Shape& shape);

}  // namespace rubric::trace
