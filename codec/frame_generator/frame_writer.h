// Writes a valid frame from the tables, from the carrier's first field on, along a route.
#pragma once

#include "codec/frame_generator/draft.h"
#include "codec/frame_generator/random.h"
#include "codec/reflect/schema.h"

namespace rubric::generate {

/// Writes a frame of at most `max_bytes` in its framing. Returns false if chance led to something
/// impossible; the next attempt may not.
bool write_frame(const reflect::Route& route, const reflect::Type& carrier, bool radio,
                 std::size_t max_bytes, Random& random, Draft& out);

}  // namespace rubric::generate
