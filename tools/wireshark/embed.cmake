# cmake -DDISSECTOR=rubric.lua -DOUT=embedded_dissector.cc -P embed.cmake: the dissector that
# `rubric install-wireshark` writes, as C++ text.
file(READ ${DISSECTOR} content)
file(WRITE ${OUT} "// Generated from tools/wireshark/generated/rubric.lua when the program is built.
#include \"tools/wireshark/folders.h\"

namespace rubric::wireshark {

std::string_view dissector() {
  static constexpr std::string_view text = R\"dissector(${content})dissector\";
  return text;
}

}  // namespace rubric::wireshark\n")
