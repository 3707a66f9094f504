// The routes to the messages, by protocol.
#pragma once

#include "codec/reflect/schema.h"

namespace rubric::generate {

/// Returns the routes of a protocol of codec/reflect/registry.h; null if it has none.
const reflect::RouteTable* routes_of(const reflect::Protocol& protocol);

/// Returns whether both are the same message. Tables are constants of each file that includes them,
/// so that the addresses of a type differ.
bool same_message(const reflect::Type* a, const reflect::Type* b);

}  // namespace rubric::generate
