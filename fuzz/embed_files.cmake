# cmake -DROOT=project -DFILES=a,b -DOUT=embedded_files.cc -P embed_files.cmake: files of the
# project as C++ text, so that a fuzz target needs none where it runs.
set(text "// Generated when the program is built.
#include \"fuzz/support/embedded_files.h\"

namespace rubric::fuzz {

const char* embedded_file(std::string_view name) {\n")
string(REPLACE "," ";" names "${FILES}")
foreach(name IN LISTS names)
  file(READ ${ROOT}/${name} content)
  string(APPEND text "  if (name == \"${name}\") return R\"file(${content})file\";\n")
endforeach()
string(APPEND text "  return nullptr;
}

}  // namespace rubric::fuzz\n")
file(WRITE ${OUT} "${text}")
