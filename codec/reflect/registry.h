// The protocols of this build, by name.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// Returns all protocols above the active-message layer.
const std::vector<const Protocol*>& protocols();

/// Returns the protocol of this id; null if there is none.
const Protocol* find_protocol(std::string_view id);

/// Returns the tables of all specs: of the protocols, and of the layers below them.
std::span<const Protocol* const> specs();
/// Returns the tables of the spec with this id; null if there is none.
const Protocol* find_spec(std::string_view id);

}  // namespace rubric::reflect
