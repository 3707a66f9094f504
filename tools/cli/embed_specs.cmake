# cmake -DROOT=project -DFILES="..." -DOUT=embedded_specs.cc -P embed_specs.cmake: the wire specs as
# C++ text, so that an installed program has them.
set(text "// Generated from spec/wire when the program is built.
#include \"tools/cli/specs.h\"

namespace rubric::cli {

const std::map<std::string, std::string_view, std::less<>>& shipped_specs() {
  static const std::map<std::string, std::string_view, std::less<>> specs = {\n")
separate_arguments(FILES)
foreach(file ${FILES})
  get_filename_component(name ${file} NAME_WE)
  file(READ ${ROOT}/${file} content)
  string(APPEND text "      {\"${name}\", R\"kaitai(${content})kaitai\"},\n")
endforeach()
string(APPEND text "  };
  return specs;
}

}  // namespace rubric::cli\n")
file(WRITE ${OUT} "${text}")
