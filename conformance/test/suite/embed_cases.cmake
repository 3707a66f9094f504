# cmake -DFOLDER=conformance/cases -DOUT=embedded_cases.cc -P embed_cases.cmake: the golden traces
# as C++ text, so that the program needs no files of its own where it is installed.
file(GLOB_RECURSE names RELATIVE ${FOLDER} ${FOLDER}/*.rtr)
list(SORT names)
set(text "// Generated from conformance/cases when the program is built.
#include \"conformance/test/suite/cases.h\"

namespace rubric::suite {

const std::vector<EmbeddedFile>& embedded_files() {
  static const std::vector<EmbeddedFile> files = {\n")
foreach(name IN LISTS names)
  file(READ ${FOLDER}/${name} trace)
  string(APPEND text "      {\"conformance/cases/${name}\", R\"rtr(${trace})rtr\"},\n")
endforeach()
string(APPEND text "  };
  return files;
}

}  // namespace rubric::suite\n")
file(WRITE ${OUT} "${text}")
