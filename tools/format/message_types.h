// The types that messages are made of.
#pragma once

#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::format {

/// All types of a protocol and those that their fields have, without the carriers and their
/// headers: these are attributes of a frame (am, frame) rather than fields. In the spec's order.
std::vector<const reflect::Type*> message_types(const reflect::Protocol& protocol);
/// The same with the carriers and their headers.
std::vector<const reflect::Type*> all_types(const reflect::Protocol& protocol);

}  // namespace rubric::format
