// The routes to the messages, by protocol.
#pragma once

#include <cstdint>

#include "codec/reflect/schema.h"
#include "codec/runtime/bytes.h"

namespace rubric::generate {

/// Returns the routes of a protocol of codec/reflect/registry.h; null if it has none.
const reflect::RouteTable* routes_of(const reflect::Protocol& protocol);

/// Returns whether both are the same message. Tables are constants of each file that includes them,
/// so that the addresses of a type differ.
bool same_message(const reflect::Type* a, const reflect::Type* b);

/// Returns the type as which an interpretation reads its bytes, by its condition and its key; null
/// if it does not. `structure`: from the start of the structure that it belongs to.
const reflect::Type* reading(const reflect::Interpretation& one, Bytes structure);

/// Returns whether another message than `wanted` might fit the last `size` bytes of `structure`,
/// which are field `index` of `type`. `before_only`: among those that are tried before `wanted`.
bool may_fit_another(const reflect::Type& type, std::uint16_t index, Bytes structure,
                     std::size_t size, const reflect::Type* wanted, bool before_only);

}  // namespace rubric::generate
