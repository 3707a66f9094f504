// The part of the dissector that no spec changes, from spec/compiler/emit/lua/lua.
#pragma once

#include <string_view>

namespace rubricc {

extern const std::string_view kLuaDecode;
extern const std::string_view kLuaCrc16;
extern const std::string_view kLuaWireshark;

}  // namespace rubricc
