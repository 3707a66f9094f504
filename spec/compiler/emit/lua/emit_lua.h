// Emits a Wireshark dissector in Lua: the specs as tables, and the code that reads them.
#pragma once

#include "spec/compiler/generated_file.h"
#include "spec/compiler/model.h"

namespace rubricc {

/// Emits tools/wireshark/generated/rubric.lua: one file for all named specs that have a serial
/// carrier, and their imports; nothing if there is none. For Lua 5.2 and later.
GeneratedFiles emit_lua(const Model& model);

}  // namespace rubricc
