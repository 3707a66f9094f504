// Turns the values in a message into single values: variables, and other values for `!x`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "conformance/trace/concrete.h"
#include "conformance/trace/schema.h"

namespace rubric::trace {

/// Returns the value with variables replaced. Throws TraceError at `*`, at a range and at an
/// unbound variable.
Value substituted(const Value& value, const Bindings& bindings, Place place);

/// Returns the number that the value means in this domain, a real as its 32 bits; with `!` another
/// one.
std::int64_t number_in(const Domain& domain, const Value& value, Place place);
/// Returns the bytes of hex or text; with `!` other bytes.
std::string bytes_in(const Value& value, Place place);

/// Returns the field by its whole path, even if it is positional; `position` counts those. Throws
/// TraceError if a path leads nowhere or to several fields, and if there are too many positional
/// ones.
FieldValue with_path(const FieldValue& field, const Shape& shape, std::size_t& position);
/// Returns all fields of a message.
std::vector<FieldValue> with_paths(const Message& message, const Shape& shape);

}  // namespace rubric::trace
