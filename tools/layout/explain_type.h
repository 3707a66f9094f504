// What `rubric explain` prints about messages, rules and names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::layout {

/// A message's layout: its fields with offsets, sizes, types, bounds, units and rules, the values
/// of its enums and masks, its own rule, and how it is reached.
std::string explain_type(const reflect::Protocol& protocol, const reflect::Type& type);

/// A rule, and the fields that refer to it in these protocols.
std::string explain_requirement(const std::vector<const reflect::Protocol*>& protocols, ReqId id);

std::string explain_enum(const reflect::Protocol& protocol, const reflect::EnumTable& table);
std::string explain_mask(const reflect::Protocol& protocol, const reflect::MaskTable& table);

}  // namespace rubric::layout
