// Names of motes' types, sensors and actuators, as spec/wire has them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"
#include "conformance/node/types.h"

namespace rubric::run {

/// Returns the number of a mote type's name, or of decimal digits up to 255. Throws
/// std::invalid_argument with all names.
std::uint8_t mote_type_of(const std::string& text);
/// Returns the bits of names with commas between them, or of decimal digits. Throws
/// std::invalid_argument with all names.
std::uint16_t transducers_of(const std::string& text);
std::uint8_t actuators_of(const std::string& text);

/// Returns the type's name; its number if it has none.
std::string mote_type_name(std::uint8_t type);
/// Returns a name for each bit that is set, lowest first: "light", "bit13".
std::vector<std::string> transducer_names(std::uint16_t bits);
std::vector<std::string> actuator_names(std::uint8_t bits);

/// Returns the unit of a telosb's readings of a sensor; null if they are raw. (demo_data)
const reflect::Unit* unit_of(const std::string& transducer);

/// Returns in words why a message was refused.
std::string refusal_text(node::Refusal refusal);

}  // namespace rubric::run
