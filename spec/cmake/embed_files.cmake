# Writes names and contents of files as C++ text, so that the program needs no files of its own
# where it is installed; see rubric_embed_files in verbs.cmake, which passes all variables.
set(text "// Generated from ${FROM} when the program is built.
#include \"${HEADER}\"

namespace ${NAMESPACE} {

const ${TYPE}& ${FUNCTION}() {
  static const ${TYPE} files = {\n")
separate_arguments(FILES)
foreach(name IN LISTS FILES)
  file(READ ${ROOT}/${name} content)
  if(STEMS)
    get_filename_component(name ${name} NAME_WE)
  endif()
  string(APPEND text "      {\"${name}\", R\"embedded(${content})embedded\"},\n")
endforeach()
string(APPEND text "  };
  return files;
}

}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUT} "${text}")
