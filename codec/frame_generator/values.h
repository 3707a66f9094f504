// Numbers for a field: some that its rule allows, some that it refuses. Bounds, reserved values and
// bytes that framings treat specially come up more often than by chance.
#pragma once

#include <cstdint>

#include "codec/frame_generator/random.h"
#include "codec/reflect/schema.h"

namespace rubric::generate {

/// Returns the least and the greatest value that the field's rule allows.
reflect::Span allowed(const reflect::Field& field);
/// Returns whether the field's rule allows it.
bool is_allowed(const reflect::Field& field, std::int64_t value);

/// Returns a value that the rule allows, at most `most`; the least allowed one if there is none.
std::int64_t allowed_value(const reflect::Field& field, reflect::Whole most, Random& random);
std::int64_t allowed_value(const reflect::Field& field, Random& random);

/// Sets `value` to one that the rule refuses, mostly next to an allowed one; returns false if it
/// refuses none.
bool refused_value(const reflect::Field& field, Random& random, std::int64_t& value);

/// Returns any byte; flags, escapes and bounds more often.
std::uint8_t any_byte(Random& random);

}  // namespace rubric::generate
