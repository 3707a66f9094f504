# cmake -DFOLDER=lua -DOUT=lua_code.cc -P embed_lua.cmake: the dissector's code as C++ text.
set(text "// Generated from spec/compiler/emit/lua/lua when the program is built.
#include \"spec/compiler/lua_code.h\"

namespace rubricc {
")
foreach(pair IN ITEMS kLuaDecode:decode kLuaCrc16:crc16 kLuaWireshark:wireshark)
  string(REPLACE ":" ";" pair "${pair}")
  list(GET pair 0 constant)
  list(GET pair 1 name)
  file(READ ${FOLDER}/${name}.lua code)
  string(APPEND text "\nconst std::string_view ${constant} = R\"lua(${code})lua\";\n")
endforeach()
string(APPEND text "\n}  // namespace rubricc\n")
file(WRITE ${OUT} "${text}")
