# cmake -DFOLDER=html -DSCRIPTS=a.js:b.js -DOUT=html_assets.cc -P embed_page.cmake: the page of a
# report as C++ text. Scripts follow one another in the given order.
file(READ ${FOLDER}/page.html page)
file(READ ${FOLDER}/style.css style)
string(REPLACE ":" ";" scripts "${SCRIPTS}")
set(script "")
foreach(name IN LISTS scripts)
  file(READ ${FOLDER}/${name} one)
  string(APPEND script "${one}")
endforeach()
set(text "// Generated from conformance/test/report/html when the program is built.
#include \"conformance/test/report/html_assets.h\"

namespace rubric::suite {
")
foreach(pair IN ITEMS kPage:page kStyle:style kScript:script)
  string(REPLACE ":" ";" pair "${pair}")
  list(GET pair 0 constant)
  list(GET pair 1 variable)
  string(APPEND text "
const std::string_view ${constant} = R\"asset(${${variable}})asset\";
")
endforeach()
string(APPEND text "
}  // namespace rubric::suite\n")
file(WRITE ${OUT} "${text}")
