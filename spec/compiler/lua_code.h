// The part of the dissector that no spec changes, from spec/compiler/emit/lua/lua.
#pragma once

#include <map>
#include <string_view>

namespace rubricc {

/// Returns the texts by the names of their files: decode, crc16, wireshark.
const std::map<std::string_view, std::string_view>& lua_code();

}  // namespace rubricc
