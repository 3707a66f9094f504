// The protocols of this build, by name.
#pragma once

#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// Returns all protocols above the active-message layer.
const std::vector<const Protocol*>& protocols();

/// Returns the protocol of this id; null if there is none.
const Protocol* find_protocol(std::string_view id);

}  // namespace rubric::reflect
