// Prints messages and names for `rubric explain`.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::explain {

/// Returns a message's layout: its fields with offsets, sizes, types, bounds, units and rules, the
/// values of its enums and masks, its own rule, and its routes.
std::string explain_type(const reflect::Protocol& protocol, const reflect::Type& type);

/// Returns "Used by rubicon: net_msg.nbytes, ...": the fields that `has` finds, a line for each
/// protocol that has one.
std::string used_by(const std::vector<const reflect::Protocol*>& protocols,
                    const std::function<bool(const reflect::Field&)>& has);

std::string explain_enum(const reflect::Protocol& protocol, const reflect::EnumTable& table);
std::string explain_mask(const reflect::Protocol& protocol, const reflect::MaskTable& table);

}  // namespace rubric::explain
