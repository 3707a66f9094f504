// The types of messages.
#pragma once

#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::format {

/// Returns all types of a protocol and those of their fields, in the spec's order, without the
/// carriers and their headers: these are attributes of a frame (am, frame) rather than fields.
std::vector<const reflect::Type*> message_types(const reflect::Protocol& protocol);
/// Returns the same with the carriers and their headers.
std::vector<const reflect::Type*> all_types(const reflect::Protocol& protocol);

}  // namespace rubric::format
