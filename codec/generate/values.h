// Numbers for a field: some that its rule allows, some that it refuses. Bounds, reserved values and
// bytes that framings treat specially come up more often than chance has them.
#pragma once

#include <cstdint>

#include "codec/generate/random.h"
#include "codec/reflect/schema.h"

namespace rubric::generate {

/// Least and greatest, both included.
struct Span {
  std::int64_t min;
  std::int64_t max;
};

/// What the field's bytes can hold. A float's are its 32 bits.
Span held(const reflect::Field& field);
/// The least and the greatest that the field's rule allows.
Span allowed(const reflect::Field& field);
/// Whether the field's rule allows it.
bool is_allowed(const reflect::Field& field, std::int64_t value);

/// A value that the rule allows, at most `most`; the least allowed one where none is.
std::int64_t allowed_value(const reflect::Field& field, std::int64_t most, Random& random);
std::int64_t allowed_value(const reflect::Field& field, Random& random);

/// A value that the rule refuses, mostly a neighbour of what it allows; false where it refuses
/// none.
bool refused_value(const reflect::Field& field, Random& random, std::int64_t& value);

/// Any byte; flags, escapes and bounds more often.
std::uint8_t any_byte(Random& random);

}  // namespace rubric::generate
